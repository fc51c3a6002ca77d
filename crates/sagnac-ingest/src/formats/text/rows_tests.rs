use super::*;

fn parse(text: &str, fields: usize, wanted: &[usize]) -> Block {
    let mut block = Block::default();
    let lines = Lines {
        separator: Separator::Byte(b','),
        decimal: b'.',
        kinds: vec![FieldKind::Number; fields],
        pairs: Vec::new(),
        comments: Comments::new(None, Some(Separator::Byte(b','))),
        void: None,
        remarks: false,
    };
    LineParser::new(&lines, wanted).parse(text.as_bytes(), &mut block);
    block
}

#[test]
fn wanted_columns_come_in_the_order_asked_for() {
    let block = parse("1,2,3\r\n4,5,6\n\n7,8,9\n", 3, &[2, 0]);
    assert_eq!(block.columns, vec![vec![3.0, 6.0, 9.0], vec![1.0, 4.0, 7.0]]);
    assert_eq!((block.lines, block.faults.len()), (4, 0));
}

#[test]
fn bad_fields_are_located_and_the_rest_of_the_line_is_kept() {
    let block = parse("0,1,x\n1,abc,x\n2,,x\n3, \"4.5\" ,x\n4,1e3,x\n", 3, &[0, 1]);
    assert_eq!(block.columns[0], vec![0.0, 1.0, 2.0, 3.0, 4.0]);
    assert_eq!(block.columns[1][0], 1.0);
    assert!(block.columns[1][1].is_nan() && block.columns[1][2].is_nan());
    assert_eq!(block.columns[1][3..], [4.5, 1000.0]);
    assert_eq!((block.unparsable.clone(), block.non_finite.clone()), (vec![0, 1], vec![0, 1]));
    let f = &block.faults[0];
    assert_eq!((f.slot, f.row, f.line, f.character, f.text.as_str()), (1, 1, 1, 3, "abc"));
}

#[test]
fn a_line_with_the_wrong_number_of_fields_gives_no_value() {
    for text in ["1,2\n3\n4,5\n", "1,2\n3,4,5\n4,5\n"] {
        let block = parse(text, 2, &[0, 1]);
        assert_eq!(block.unparsable, vec![1, 1], "{text}");
        assert!(block.columns[0][1].is_nan() && block.columns[1][1].is_nan(), "{text}");
        assert_eq!(block.columns[1][2], 5.0);
    }
    let block = parse("1,2,9\n3,4\n5,6,9\n", 3, &[0]);
    assert_eq!(block.unparsable, vec![1]);
}

#[test]
fn a_separator_at_the_end_of_a_line_is_no_field() {
    let block = parse("1,2,\n3,4,\n", 2, &[0, 1]);
    assert_eq!(block.columns, vec![vec![1.0, 3.0], vec![2.0, 4.0]]);
    assert_eq!(block.unparsable, vec![0, 0]);
}

#[test]
fn separators_between_quotes_do_not_count() {
    let block = parse("1,\"a,b\",3\n", 3, &[2]);
    assert_eq!(block.columns, vec![vec![3.0]]);
}
