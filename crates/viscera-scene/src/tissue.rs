//! Tissues by name: `law = { tissue = "liver" }` stands for the law, the numbers and the density that the engine has for liver.
//!
//! They are written into the document before it is checked, where the file says nothing of its own. What comes after knows the
//! numbers only: a parameter that is changed then is not liver's any more.

use schemars::Schema;
use serde_json::{Map, Value as Json, json};
use viscera::material::TissuePreset;

use crate::document::{Document, Node, Span, Value};

/// The key of a law that names a tissue.
const KEY: &str = "tissue";

/// The document with every tissue's numbers in it.
pub(crate) fn written_out(document: &Document) -> Document {
    let mut document = document.clone();
    let bodies = document.root.child_mut("body").into_iter().flat_map(Node::children_mut);
    for body in bodies {
        write_out(body, None);
        let kind = body.child("law").and_then(|law| law.child("kind")).and_then(Node::text).map(str::to_owned);
        for part in body.child_mut("part").into_iter().flat_map(Node::children_mut) {
            write_out(part, kind.as_deref());
        }
    }
    document
}

/// Fills in what the law of a body or part leaves to its tissue. A part has the kind of law of its body, `kind`.
fn write_out(owner: &mut Node, kind: Option<&str>) {
    let Some(law) = owner.child_mut("law") else { return };
    let Some((name, span)) = law.child(KEY).and_then(|node| Some((node.text()?, node.span.clone()))) else { return };
    // A name that is not known is found by the check; any tissue in its place keeps the check from missing its numbers too.
    let Some(preset) = TissuePreset::named(name).or(TissuePreset::ALL.first()) else { return };
    give(law, "kind", Value::Text(kind.unwrap_or(preset.law.name()).to_owned()), &span);
    // Fibres hold the sides of what is pulled across them: the matrix between them is softer than the tissue.
    let has = |table: &Node, keys: &[&str]| keys.iter().any(|key| table.child(key).is_some());
    let fibred = law.child("fibre").is_some_and(|fibre| !has(fibre, &["young", "factor", "lambda", "mu"]));
    let (mut young, mut factor) = (preset.young.value, None);
    if let (true, Ok(Some((matrix, times)))) = (fibred, preset.matrix_and_factor()) {
        (young, factor) = (matrix.young(), Some(times));
    }
    if !has(law, &["lambda", "mu"]) {
        give(law, "young", Value::Number(young), &span);
        give(law, "poisson", Value::Number(preset.poisson.value), &span);
    }
    if let (Some(factor), Some(fibre)) = (factor, law.child_mut("fibre")) {
        give(fibre, "factor", Value::Number(factor), &span);
    }
    give(owner, "density", Value::Number(preset.density.value), &span);
}

/// Puts a value under a key that the table has not.
fn give(table: &mut Node, key: &str, value: Value, span: &Span) {
    table.put_if_absent(key, Node { value, span: span.clone() });
}

/// The data of a document that is written out, without the names.
pub(crate) fn without_names(mut scene: Json) -> Json {
    for body in scene.get_mut("body").and_then(Json::as_object_mut).into_iter().flat_map(Map::values_mut) {
        forget(body);
        body.get_mut("part").and_then(Json::as_array_mut).into_iter().flatten().for_each(forget);
    }
    scene
}

fn forget(owner: &mut Json) {
    if let Some(law) = owner.get_mut("law").and_then(Json::as_object_mut) {
        law.remove(KEY);
    }
}

/// Lets a law name its tissue, which then gives its kind.
pub(crate) fn with_tissue(schema: &mut Schema) {
    let names: Vec<&str> = TissuePreset::ALL.iter().map(|preset| preset.name).collect();
    if let Some(Json::Object(properties)) = schema.get_mut("properties") {
        let description = "A tissue of the list: it gives the law, its numbers, the stiffness of fibres and the density, each where \
                           the file gives none.";
        properties.insert(KEY.into(), json!({ "description": description, "type": "string", "enum": names }));
    }
    required_unless(schema, "kind", json!({ "required": [KEY] }));
}

/// Lets a body go without a density where its law names a tissue.
pub(crate) fn with_density_of_tissue(schema: &mut Schema) {
    required_unless(schema, "density", json!({ "properties": { "law": { "type": "object", "required": [KEY] } } }));
}

/// Requires a key only where the table does not fit `otherwise`.
fn required_unless(schema: &mut Schema, key: &str, otherwise: Json) {
    if let Some(Json::Array(required)) = schema.get_mut("required") {
        required.retain(|name| name != key);
    }
    schema.insert("if".into(), json!({ "not": otherwise }));
    schema.insert("then".into(), json!({ "required": [key] }));
}
