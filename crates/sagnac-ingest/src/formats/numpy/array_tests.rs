use super::*;

fn npy(version: u8, text: &str) -> Vec<u8> {
    let mut out = MAGIC.to_vec();
    out.extend_from_slice(&[version, 0]);
    match version {
        1 => out.extend_from_slice(&(text.len() as u16).to_le_bytes()),
        _ => out.extend_from_slice(&(text.len() as u32).to_le_bytes()),
    }
    out.extend_from_slice(text.as_bytes());
    out
}

fn columns(descr: &str, fortran: &str, shape: &str) -> Columns {
    let text = format!("{{'descr': {descr}, 'fortran_order': {fortran}, 'shape': {shape}, }}\n");
    let head = npy(1, &text);
    let array = header(&head).unwrap();
    assert_eq!(array.data_at, head.len() as u64);
    array.columns("", &[]).unwrap_or_else(|(note, _)| panic!("{note:?}"))
}

/// Rows, columns, true where rows stand together, stride.
fn shape(c: &Columns) -> (u64, usize, bool, usize) {
    (c.rows, c.list.len(), c.by_rows, c.stride)
}

#[test]
fn rows_and_columns_follow_from_shape_and_order() {
    assert_eq!(shape(&columns("'<f8'", "False", "(1000,)")), (1000, 1, true, 8));
    assert_eq!(shape(&columns("'<f8'", "False", "(1000, 3)")), (1000, 3, true, 24));
    assert_eq!(shape(&columns("'<f4'", "True", "(1000, 3)")), (1000, 3, false, 4));
    assert_eq!(shape(&columns("'<f4'", "False", "(3, 1000)")), (1000, 3, false, 4));
    assert_eq!(shape(&columns("'<f4'", "True", "(3, 1000)")), (1000, 3, true, 12));
    assert_eq!(shape(&columns("'<f4'", "False", "(1, 50)")), (50, 1, true, 4));
    assert_eq!(shape(&columns("'<f4'", "False", "(10, 64)")), (10, 64, true, 256));
    assert!(columns("'<f4'", "False", "(3, 1000)").note.is_some());
    let c = columns("'<f4'", "True", "(1000, 3)");
    assert_eq!(c.list.iter().map(|p| p.from).collect::<Vec<_>>(), [0, 4000, 8000]);
    assert_eq!(
        c.list.iter().map(|p| p.column.name.as_str()).collect::<Vec<_>>(),
        ["column_1", "column_2", "column_3"]
    );
}

#[test]
fn what_is_no_array_of_numbers_is_refused() {
    for (version, text, key) in [
        (9, "{}", "ingest.npy.version"),
        (1, "{'descr': '<f8', 'fortran_order': False}", "ingest.npy.no_key"),
        (1, "{'descr': '<f8', 'fortran_order': 3, 'shape': (3,)}", "ingest.npy.no_key"),
        (2, "{'descr': '<f8', 'fortran_order': False, 'shape': 'x'}", "ingest.npy.no_key"),
        (
            3,
            "{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999, 99999999999)}",
            "ingest.npy.no_key",
        ),
        (1, "{'descr': '|O', 'fortran_order': False, 'shape': (3,)}", "ingest.npy.objects"),
        (1, "{'descr': '<x9', 'fortran_order': False, 'shape': (3,)}", "ingest.npy.type"),
        (1, "import os", "ingest.npy.header_damaged"),
    ] {
        assert_eq!(header(&npy(version, text)).unwrap_err().0.id, key, "{text}");
    }
    let array = header(&npy(1, "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 4, 5)}")).unwrap();
    assert_eq!(array.columns("", &[]).err().unwrap().0.id, "ingest.npy.dimensions");
    let array = header(&npy(1, "{'descr': '<f8', 'fortran_order': False, 'shape': (90000, 90000)}")).unwrap();
    assert_eq!(array.columns("", &[]).err().unwrap().0.id, "ingest.binary.too_many_columns");
    let whole = npy(1, "{'descr': '<f8', 'fortran_order': False, 'shape': (3,), }");
    for n in 0..whole.len() {
        assert!(header(&whole[..n]).is_err(), "{n}");
    }
}

#[test]
fn dates_count_from_the_whole_second_before_the_first() {
    let ns = Ticks { zero: 0, tick_s: (1.0, 1e9) };
    assert_eq!(zero(ns, Some(1_700_000_000_250_000_000)), (1_700_000_000_000_000_000, 1.7e9));
    assert_eq!(zero(ns, Some(-1)), (-1_000_000_000, -1.0));
    assert_eq!(zero(Ticks { zero: 0, tick_s: (10.0, 1e3) }, Some(123)), (100, 1.0));
    assert_eq!(zero(Ticks { zero: 0, tick_s: (86_400.0, 1.0) }, Some(2)), (2, 172_800.0));
    // Seven milliseconds do not divide the second: the first date itself is the zero.
    assert_eq!(zero(Ticks { zero: 0, tick_s: (7.0, 1e3) }, Some(150)), (150, 1.05));
    assert_eq!(zero(ns, None), (0, 0.0));
}
