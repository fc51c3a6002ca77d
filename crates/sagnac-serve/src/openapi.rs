//! The description of the interface (OpenAPI 3.1), made from the table of routes.

use crate::routes::{API, Access, ROUTES, Route, Takes};
use serde_json::{Map, Value, json};

/// The description.
pub fn description() -> Value {
    let mut paths = Map::new();
    for route in ROUTES.iter().filter(|route| !route.operation.is_empty()) {
        let path = route.path.strip_prefix(API).unwrap_or(route.path).replace("{*", "{");
        let method = route.method.as_str().to_ascii_lowercase();
        let entry = paths.entry(path).or_insert_with(|| json!({}));
        if let Some(entry) = entry.as_object_mut() {
            entry.insert(method, operation(route));
        }
    }
    json!({
        "openapi": "3.1.0",
        "info": {
            "title": "sagnac serve",
            "version": env!("CARGO_PKG_VERSION"),
            "description": "Tests of gyroscopes in a queue. Each is a run of the program; its result is result.json.",
        },
        "servers": [{ "url": API }],
        "security": [{ "token": [] }],
        "paths": paths,
        "components": {
            "securitySchemes": { "token": { "type": "http", "scheme": "bearer" } },
            "schemas": schemas(),
        },
    })
}

fn operation(route: &Route) -> Value {
    let mut operation = json!({
        "operationId": route.operation,
        "summary": route.summary,
        "responses": responses(route),
    });
    let Some(members) = operation.as_object_mut() else { return operation };
    let mut parameters: Vec<Value> = route.path.split('/').filter_map(in_path).collect();
    match route.operation {
        "list" => parameters.extend([
            in_query("state", json!({ "$ref": "#/components/schemas/State" })),
            in_query("serial", json!({ "type": "string" })),
            in_query("limit", json!({ "type": "integer", "minimum": 0, "maximum": 1000, "default": 100 })),
        ]),
        "events" => parameters.push(json!({
            "name": "Last-Event-ID", "in": "header", "schema": { "type": "integer", "minimum": 0 },
            "description": "Number of the last event that was received: later ones are sent, as far as they are kept",
        })),
        _ => {}
    }
    if !parameters.is_empty() {
        members.insert("parameters".to_owned(), parameters.into());
    }
    if route.access == Access::Open {
        members.insert("security".to_owned(), json!([]));
    }
    if route.takes == Takes::Upload {
        members.insert(
            "requestBody".to_owned(),
            json!({
                "required": true,
                "content": {
                    "application/json": { "schema": { "$ref": "#/components/schemas/Order" } },
                    "multipart/form-data": { "schema": { "$ref": "#/components/schemas/Upload" } },
                },
            }),
        );
    }
    operation
}

fn in_path(part: &str) -> Option<Value> {
    let name = part.strip_prefix('{')?.strip_suffix('}')?;
    let name = name.strip_prefix('*').unwrap_or(name);
    Some(json!({ "name": name, "in": "path", "required": true, "schema": { "type": "string" } }))
}

fn in_query(name: &str, schema: Value) -> Value {
    json!({ "name": name, "in": "query", "schema": schema })
}

fn responses(route: &Route) -> Value {
    let body = |schema: &str| json!({ "application/json": { "schema": { "$ref": format!("#/components/schemas/{schema}") } } });
    let (status, description, content) = match route.operation {
        "order" => ("202", "Queued", body("Run")),
        "cancel" => ("202", "Cancelled, or about to end", body("Run")),
        "run" => ("200", "The test", body("Run")),
        "list" => ("200", "Tests", body("Runs")),
        "unit" => ("200", "Attempts", body("Unit")),
        "events" => (
            "200",
            "Events `state`, `progress` and `ended`, each with a number",
            json!({ "text/event-stream": { "schema": { "type": "string" } } }),
        ),
        "result" => ("200", "The file", json!({ "*/*": { "schema": {} } })),
        _ => ("200", "Done", json!({ "application/json": { "schema": { "type": "object" } } })),
    };
    let refusal = |description: &str| json!({ "description": description, "content": body("Refusal") });
    let mut all = json!({ status: { "description": description, "content": content } });
    let Some(members) = all.as_object_mut() else { return all };
    let mut add = |status: &str, description: &str| {
        members.insert(status.to_owned(), refusal(description));
    };
    add("421", "The host is none of this server's");
    if route.access == Access::Token {
        add("401", "Without the token");
        add("403", "Asked by a page of another server, or a recording outside of the folders");
    }
    if route.path.contains('{') {
        add("404", "Not known");
    }
    match route.operation {
        "order" => {
            add("400", "Malformed");
            add("408", "Too slow");
            add("413", "Too large");
            add("415", "Neither JSON nor a form with parts");
            add("422", "Something is missing or not known");
            add("503", "The queue is full");
            add("507", "The quota of uploads is used up");
        }
        "cancel" => add("409", "It has ended"),
        "events" => add("503", "Too many streams"),
        _ => {}
    }
    all
}

fn schemas() -> Value {
    let text = json!({ "type": "string", "maxLength": 200 });
    let order = json!({
        "serial": text, "recording": { "type": "string", "description": "Path below a folder of recordings" },
        "procedure": { "type": "string", "description": "Default: that of the part number" },
        "limits": { "type": "string" }, "part": text, "lot": text, "operator": text,
        "reason": { "type": "string", "maxLength": 200, "description": "Why the unit is tested again" },
    });
    let mut upload = order.clone();
    if let Some(members) = upload.as_object_mut() {
        members.remove("recording");
        members.insert(
            "file".to_owned(),
            json!({ "type": "string", "contentMediaType": "application/octet-stream" }),
        );
    }
    let optional = json!({ "type": ["string", "null"] });
    let words = json!({ "type": "array", "items": { "type": "string" } });
    let required = json!({ "type": "string" });
    json!({
        "Order": { "type": "object", "required": ["serial", "recording"], "properties": order, "additionalProperties": false },
        "Upload": { "type": "object", "required": ["serial", "file"], "properties": upload },
        "State": { "type": "string", "enum": ["queued", "running", "done", "failed", "cancelled"] },
        "Verdict": { "type": ["string", "null"], "enum": ["none", "pass", "indeterminate", "fail", "error", null] },
        "Run": {
            "type": "object",
            "properties": {
                "id": required, "state": { "$ref": "#/components/schemas/State" },
                "place": { "type": ["integer", "null"], "description": "Among those that wait, from 1" },
                "serial": required, "part": optional, "lot": optional, "operator": optional, "reason": optional,
                "recording": required, "procedure": required, "limits": required,
                "ordered_at": { "type": "string", "format": "date-time" },
                "ended_at": { "type": ["string", "null"], "format": "date-time" },
                "progress": optional, "verdict": { "$ref": "#/components/schemas/Verdict" },
                "reasons": words, "next": optional,
                "said": { "type": ["string", "null"], "description": "What the process said where there is no result" },
                "events": required, "result": optional, "report": optional,
            },
            "required": ["id", "state", "serial", "recording", "procedure", "ordered_at", "events"],
        },
        "Runs": { "type": "object", "properties": { "runs": { "type": "array", "items": { "$ref": "#/components/schemas/Run" } } } },
        "Unit": { "type": "object", "properties": { "serial": required, "attempts": { "type": "array", "items": { "$ref": "#/components/schemas/Run" } } } },
        "Refusal": {
            "type": "object", "required": ["error", "message"],
            "properties": { "error": { "type": "string", "description": "Id, the same in every language" }, "message": required },
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_route_is_described_and_every_reference_has_its_schema() {
        let all = description();
        let text = all.to_string();
        for route in ROUTES.iter().filter(|r| r.path.starts_with(API)) {
            let path = route.path.strip_prefix(API).unwrap().replace("{*", "{");
            let operation = &all["paths"][&path][route.method.as_str().to_ascii_lowercase()];
            assert_eq!(operation["operationId"], route.operation, "{path}");
        }
        for part in text.split("#/components/schemas/").skip(1) {
            let name = part.split('"').next().unwrap();
            assert!(all["components"]["schemas"][name].is_object(), "{name}");
        }
        assert!(all["paths"]["/results/{id}/{file}"]["get"]["parameters"].as_array().unwrap().len() == 2);
    }
}
