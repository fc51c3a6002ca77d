//! A small JSON Schema validator for the schema of results.

use serde_json::{Map, Value};

/// Checks a value against a schema; keywords that it does not know are errors, so that nothing passes unseen.
pub fn validate(schema: &Value, root: &Value, value: &Value, at: &str) -> Result<(), String> {
    let Some(keywords) = schema.as_object() else {
        return if schema == &Value::Bool(true) {
            Ok(())
        } else {
            Err(format!("{at}: nothing may stand here"))
        };
    };
    let wrong = |what: &str| Err(format!("{at}: {what}: {value}"));
    for (keyword, rule) in keywords {
        match keyword.as_str() {
            "$schema" | "$defs" | "title" | "description" | "format" | "default" => {}
            "$ref" => {
                let pointer = rule.as_str().and_then(|r| r.strip_prefix('#')).ok_or("odd reference")?;
                let target = root.pointer(pointer).ok_or_else(|| format!("no {pointer}"))?;
                validate(target, root, value, at)?;
            }
            "type" => {
                let several = rule.as_array().cloned().unwrap_or_else(|| vec![rule.clone()]);
                if !several.iter().any(|t| has_type(value, t)) {
                    return wrong(&format!("not of type {rule}"));
                }
            }
            "const" if value != rule => return wrong("not the constant"),
            "enum" if !rule.as_array().is_some_and(|l| l.contains(value)) => return wrong("not in the list"),
            "const" | "enum" => {}
            "minimum" if value.as_f64().is_some_and(|v| v < rule.as_f64().unwrap_or(f64::NAN)) => {
                return wrong("too small");
            }
            "minimum" => {}
            "anyOf" | "oneOf" => {
                let options = rule.as_array().ok_or("odd alternatives")?;
                let fits = options.iter().filter(|o| validate(o, root, value, at).is_ok()).count();
                if fits == 0 || (keyword == "oneOf" && fits > 1) {
                    return wrong(&format!("{fits} alternatives fit"));
                }
            }
            "required" => {
                for key in rule.as_array().into_iter().flatten().filter_map(Value::as_str) {
                    if value.as_object().is_some_and(|o| !o.contains_key(key)) {
                        return wrong(&format!("`{key}` is missing"));
                    }
                }
            }
            "properties" | "additionalProperties" => validate_members(keywords, root, value, at)?,
            "items" => {
                for (i, item) in value.as_array().into_iter().flatten().enumerate() {
                    validate(rule, root, item, &format!("{at}[{i}]"))?;
                }
            }
            "minItems" | "maxItems" => {
                let (n, bound) = (value.as_array().map_or(0, Vec::len) as u64, rule.as_u64().unwrap_or(0));
                if value.is_array()
                    && ((keyword == "minItems" && n < bound) || (keyword == "maxItems" && n > bound))
                {
                    return wrong("wrong number of items");
                }
            }
            other => return Err(format!("{at}: the test does not know `{other}`")),
        }
    }
    Ok(())
}

/// Members of an object: those that the schema names, and what it says of all others.
fn validate_members(
    schema: &Map<String, Value>,
    root: &Value,
    value: &Value,
    at: &str,
) -> Result<(), String> {
    for (key, member) in value.as_object().into_iter().flatten() {
        let rule = schema.get("properties").and_then(|p| p.get(key)).or(schema.get("additionalProperties"));
        if let Some(rule) = rule {
            validate(rule, root, member, &format!("{at}.{key}"))?;
        }
    }
    Ok(())
}

fn has_type(value: &Value, name: &Value) -> bool {
    match name.as_str() {
        Some("null") => value.is_null(),
        Some("boolean") => value.is_boolean(),
        Some("integer") => value.is_i64() || value.is_u64(),
        Some("number") => value.is_number(),
        Some("string") => value.is_string(),
        Some("array") => value.is_array(),
        Some("object") => value.is_object(),
        _ => false,
    }
}

/// The schema with `additionalProperties: false` everywhere, to find fields that it does not describe.
pub fn closed(schema: &Value) -> Value {
    match schema {
        Value::Object(o) => {
            let mut closed: Map<String, Value> =
                o.iter().map(|(k, v)| (k.clone(), self::closed(v))).collect();
            if o.get("properties").is_some_and(Value::is_object) && o.get("type") == Some(&"object".into()) {
                closed.entry("additionalProperties").or_insert(Value::Bool(false));
            }
            Value::Object(closed)
        }
        Value::Array(a) => Value::Array(a.iter().map(closed).collect()),
        other => other.clone(),
    }
}
