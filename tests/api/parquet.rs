//! Points and series as Parquet files: the numbers are those of the JSON, to the bit. Programs without the feature
//! refuse the form in words.

use crate::support::*;

const MEDIA_TYPE: &str = "application/vnd.apache.parquet";

/// What is served is described, and nothing else.
#[tokio::test]
async fn the_description_has_the_form_where_the_program_has_it() {
    let app = app().await;
    let document = app.get("/openapi.json").await.json;
    for path in ["/api/v1/jobs/{id}/series", "/api/v1/jobs/{id}/points"] {
        let operation = &document["paths"][path]["get"];
        let content = operation["responses"]["200"]["content"].as_object().expect("media types");
        assert_eq!(content.contains_key(MEDIA_TYPE), cfg!(feature = "parquet"), "{path}");
        let parameters = operation["parameters"].as_array().expect("parameters");
        let format = parameters.iter().find(|parameter| parameter["name"] == "format").expect("format");
        let pattern = format["schema"]["pattern"].as_str().expect("a pattern");
        assert!(pattern.contains("|mat"), "{pattern}");
        assert_eq!(pattern.contains("parquet"), cfg!(feature = "parquet"), "{pattern}");
    }
}

#[cfg(not(feature = "parquet"))]
#[tokio::test]
async fn a_program_without_the_feature_says_so() {
    let app = app().await;
    let (job, _) = app.run(&document()).await;
    let (rows, _) = app.run(&sweep("all", 2)).await;
    for path in [format!("{job}/series"), format!("{rows}/points")] {
        for (query, accept) in [("", MEDIA_TYPE), ("?format=parquet", "*/*")] {
            let refused = app.get_with(&format!("{path}{query}"), &[("accept", accept)]).await;
            refused.assert_problem(406, "not-acceptable");
            let detail = refused.json["detail"].as_str().expect("a detail");
            assert!(detail.contains("built without Parquet") && detail.contains("application/x-npz"), "{detail}");
        }
        // Whoever takes another form as well gets it.
        let other = app.get_with(&path, &[("accept", &format!("{MEDIA_TYPE}, application/json;q=0.5"))]).await;
        assert_eq!((other.status, other.header("content-type")), (200, "application/json"));
    }
    let result = app.get_with(&format!("{job}/result"), &[("accept", MEDIA_TYPE)]).await;
    result.assert_problem(406, "not-acceptable");
    assert!(!result.text().contains("Parquet"), "results never have that form: {}", result.text());
}

#[cfg(feature = "parquet")]
mod read_back {
    use super::*;
    use axum::body::Bytes;
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;
    use serde_json::Value;
    use std::collections::BTreeMap;

    /// A file: its columns by their names, its metadata, and the number of its groups of rows.
    struct File {
        columns: BTreeMap<String, Vec<Field>>,
        metadata: BTreeMap<String, String>,
        n_groups: usize,
    }

    impl File {
        fn read(answer: &Answer) -> Self {
            assert_eq!(
                (answer.status, answer.header("content-type"), answer.header("vary")),
                (200, MEDIA_TYPE, "accept")
            );
            let file = SerializedFileReader::new(Bytes::copy_from_slice(&answer.body)).expect("a Parquet file");
            let metadata = file.metadata().file_metadata();
            let entries = metadata.key_value_metadata().into_iter().flatten();
            let entries = entries.map(|entry| (entry.key.clone(), entry.value.clone().unwrap_or_default()));
            let schema = metadata.schema_descr();
            let names = (0..schema.num_columns()).map(|index| schema.column(index).name().to_owned());
            let mut columns: BTreeMap<_, Vec<Field>> = names.map(|name| (name, Vec::new())).collect();
            for row in file.get_row_iter(None).expect("rows") {
                for (name, field) in row.expect("a row").into_columns() {
                    columns.get_mut(&name).expect("a column").push(field);
                }
            }
            Self { metadata: entries.collect(), n_groups: file.num_row_groups(), columns }
        }

        /// The bits of a column of numbers; `None` where it has null.
        fn bits(&self, name: &str) -> Vec<Option<u64>> {
            let column = self.columns.get(name).unwrap_or_else(|| panic!("no {name}: {:?}", self.columns.keys()));
            let bits = |field: &Field| match field {
                Field::Double(value) => Some(value.to_bits()),
                Field::Null => None,
                other => panic!("{name}: {other:?}"),
            };
            column.iter().map(bits).collect()
        }
    }

    fn bits(values: &Value) -> Vec<Option<u64>> {
        values.as_array().expect("a list").iter().map(|value| value.as_f64().map(f64::to_bits)).collect()
    }

    #[tokio::test]
    async fn a_series_over_all_its_parts_and_in_a_window() {
        let app = app().await;
        let (path, _) = app.run(&scripted("large")).await;
        let json = app.get(&format!("{path}/series/a_x_left?method=none")).await.json;
        let answer = app.get(&format!("{path}/series?channels=a_x_left&format=parquet")).await;
        assert!(answer.header("content-disposition").ends_with("-series.parquet\""));
        let file = File::read(&answer);
        assert!(file.n_groups > 1, "samples in several parts");
        let url = format!("{path}/series?format=parquet");
        let packed = app.get_with(&url, &[("accept-encoding", "gzip")]).await;
        assert_eq!((packed.status, packed.header("content-encoding")), (200, "gzip"), "sent to its end");
        assert!(file.bits("a_x_left") == bits(&json["y"]) && file.bits("t_s") == bits(&json["t"]));
        assert_eq!(file.metadata["dt_s"].parse(), Ok(1e-4));
        assert!(path.ends_with(&file.metadata["job_id"]) && !file.metadata["solver_version"].is_empty());
        let units: Value = serde_json::from_str(&file.metadata["units"]).expect("JSON");
        assert_eq!((&units["t_s"], &units["a_x_left"]), (&"s".into(), &json["unit"]));
        for (query, is_empty) in [("from=30&to=60", false), ("to=0.6", false), ("from=1e6", true)] {
            let window = app.get(&format!("{path}/series/a_x_left?method=none&{query}")).await.json;
            let answer = app.get_with(&format!("{path}/series?{query}"), &[("accept", MEDIA_TYPE)]).await;
            let file = File::read(&answer);
            assert_eq!(file.bits("t_s").is_empty(), is_empty, "{query}");
            assert!(file.bits("a_x_left") == bits(&window["y"]) && file.bits("t_s") == bits(&window["t"]), "{query}");
        }
    }

    #[tokio::test]
    async fn points_with_null_where_there_is_no_value() {
        let app = app().await;
        let mut document = sweep("all", 4);
        document["axes"][0]["from"] = 1000.1.into();
        let (path, _) = app.run(&document).await;
        let answer = app.get_with(&format!("{path}/points"), &[("accept", MEDIA_TYPE)]).await;
        assert!(answer.header("content-disposition").ends_with("-points.parquet\""));
        let file = File::read(&answer);
        let items = app.get(&format!("{path}/points")).await.json["items"].clone();
        let speeds: Value = items.as_array().unwrap().iter().map(|item| item["point"]["values"][0].clone()).collect();
        assert_eq!(file.bits("/operation/pinion_speed_rpm"), bits(&speeds));
        assert_eq!(file.columns["position"], [0, 1, 2, 3].map(Field::Long));
        assert_eq!(file.columns["branch"], vec![Field::Null; 4]);
        let columns = app.get(&format!("{path}/points/columns")).await.json["columns"].clone();
        let mut n_numbers = 0;
        for (name, values) in columns.as_object().expect("columns") {
            let texts = values.as_array().unwrap().iter().any(Value::is_string);
            match file.columns.get(name) {
                Some(fields) if texts => {
                    let expected = values.as_array().unwrap().iter().map(|value| match value.as_str() {
                        Some(text) => Field::Str(text.to_owned()),
                        None => Field::Null,
                    });
                    assert_eq!(fields, &expected.collect::<Vec<_>>(), "{name}");
                }
                Some(_) => {
                    n_numbers += 1;
                    assert_eq!(file.bits(name), bits(values), "{name}");
                }
                None => panic!("{name} is no column of the file"),
            }
        }
        assert!(n_numbers > 20, "{n_numbers} columns of numbers");
        let input: Value = serde_json::from_str(&file.metadata["input"]).expect("JSON");
        assert_eq!(input["axes"], app.get(&format!("{path}/input")).await.json["axes"]);
        let two = File::read(&app.get(&format!("{path}/points?format=parquet&from=1&limit=2")).await);
        assert_eq!(two.bits("/operation/pinion_speed_rpm"), bits(&speeds)[1..3]);
        let conflict = app.get(&format!("{path}/points?format=parquet&decimal=comma")).await;
        conflict.assert_problem(400, "invalid-parameter");
        conflict.violation("/decimal");
    }
}
