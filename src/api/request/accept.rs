//! Content negotiation by the header `Accept`.

use super::query::QueryParameters;
use crate::api::csv::Decimal;
use crate::api::parquet;
use crate::api::problem::{ApiError, ProblemCode};
use crate::api::workbook::MEDIA_TYPE;
use axum::extract::Request;
use axum::http::HeaderMap;
use axum::http::header::ACCEPT;
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use herringbone_exchange::arrays::ArrayForm;
use herringbone_job::Violation;

/// Selects the offered media type with the highest quality in `Accept`; the first offer without that header.
///
/// # Errors
/// 406 when `Accept` permits none of them.
pub(crate) fn negotiate(headers: &HeaderMap, offers: &[&'static str]) -> Result<&'static str, ApiError> {
    let ranges = media_ranges(headers);
    let mut best: Option<(&'static str, f32)> = None;
    for offer in offers {
        let quality = if ranges.is_empty() { 1.0 } else { quality(&ranges, offer) };
        if quality > best.map_or(0.0, |(_, known)| known) {
            best = Some((offer, quality));
        }
    }
    best.map(|(offer, _)| offer)
        .ok_or_else(|| ApiError::new(ProblemCode::NotAcceptable, format!("This path has: {}.", offers.join(", "))))
}

/// Selects one of the forms in which a path answers: by the query parameter `format`, or by `Accept`; the first one
/// without either. Each form is given with its name and media type.
///
/// # Errors
/// 406 when `Accept` permits none of them, or not the one that the query selects, or the program was built without it.
pub(crate) fn negotiate_form<T: Copy>(
    headers: &HeaderMap,
    query: &mut QueryParameters,
    forms: &[(&'static str, &'static str, T)],
) -> Result<T, ApiError> {
    let names: Vec<_> = forms.iter().map(|form| (form.0, form)).collect();
    let chosen = query.choice("format", &names);
    let is_built = |media_type: &str| parquet::IS_BUILT || media_type != parquet::MEDIA_TYPE;
    let built: Vec<_> = forms.iter().map(|form| form.1).filter(|media_type| is_built(media_type)).collect();
    let offers = match chosen {
        Some(form) if !is_built(form.1) => return Err(parquet::missing(&built)),
        Some(form) => vec![form.1],
        None => built.clone(),
    };
    let media_type = negotiate(headers, &offers).map_err(|error| {
        let is_accepted = media_ranges(headers).iter().any(|(range, _)| range == parquet::MEDIA_TYPE);
        if is_accepted && built.len() < forms.len() { parquet::missing(&built) } else { error }
    })?;
    let form = chosen.or_else(|| forms.iter().find(|form| form.1 == media_type));
    form.map(|form| form.2).ok_or_else(|| ApiError::internal("a media type that was not offered"))
}

/// Selects the representation of a table: CSV with a decimal sign, or JSON (`None`). The query parameter `decimal`
/// selects CSV and its dialect; `Accept: text/csv`, which may have the parameter `decimal`, selects CSV.
///
/// # Errors
/// 406 when `Accept` permits neither JSON nor CSV, or not CSV although the query selects it.
pub(crate) fn negotiate_table(headers: &HeaderMap, query: &mut QueryParameters) -> Result<Option<Decimal>, ApiError> {
    if let Some(decimal) = query.choice("decimal", &Decimal::ALL) {
        return negotiate(headers, &["text/csv"]).map(|_| Some(decimal));
    }
    match negotiate(headers, &["application/json", "text/csv"])? {
        "text/csv" => accepted_decimal(headers).map(Some),
        _ => Ok(None),
    }
}

/// The representation of the rows of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TableForm {
    Json,
    Csv(Decimal),
    Workbook,
    Arrays(ArrayForm),
    Parquet,
}

/// Selects the representation of the rows of a sweep: by the query parameter `format`, by `decimal` (CSV), or by
/// `Accept`.
///
/// # Errors
/// 406 when `Accept` permits none of them, or not the one that the query selects.
pub(crate) fn negotiate_table_form(headers: &HeaderMap, query: &mut QueryParameters) -> Result<TableForm, ApiError> {
    const FORMS: [(&str, &str, TableForm); 6] = [
        ("json", "application/json", TableForm::Json),
        ("csv", "text/csv", TableForm::Csv(Decimal::Point)),
        ("xlsx", MEDIA_TYPE, TableForm::Workbook),
        ("npz", "application/x-npz", TableForm::Arrays(ArrayForm::Npz)),
        ("mat", "application/x-matlab-data", TableForm::Arrays(ArrayForm::Mat)),
        (parquet::NAME, parquet::MEDIA_TYPE, TableForm::Parquet),
    ];
    let Some(decimal) = query.choice("decimal", &Decimal::ALL) else {
        return match negotiate_form(headers, query, &FORMS)? {
            TableForm::Csv(_) => accepted_decimal(headers).map(TableForm::Csv),
            form => Ok(form),
        };
    };
    let names = FORMS.map(|(name, _, form)| (name, form));
    if query.choice("format", &names).is_some_and(|form| !matches!(form, TableForm::Csv(_))) {
        query.add_violation(Violation::new("/decimal", "conflict", "is of CSV only, not of another format"));
    }
    negotiate(headers, &["text/csv"]).map(|_| TableForm::Csv(decimal))
}

/// Selects the dialect of a table that there is only as CSV: by the query parameter `decimal`, or by the parameter
/// `decimal` of `Accept: text/csv`.
///
/// # Errors
/// 406 when `Accept` does not permit CSV.
pub(crate) fn negotiate_csv(headers: &HeaderMap, query: &mut QueryParameters) -> Result<Decimal, ApiError> {
    let decimal = query.choice("decimal", &Decimal::ALL);
    negotiate(headers, &["text/csv"])?;
    decimal.map_or_else(|| accepted_decimal(headers), Ok)
}

/// The parameter `decimal` of the range `text/csv` in `Accept`.
fn accepted_decimal(headers: &HeaderMap) -> Result<Decimal, ApiError> {
    let lines = headers.get_all(ACCEPT).into_iter().filter_map(|value| value.to_str().ok());
    for member in lines.flat_map(|line| line.split(',')) {
        let mut parts = member.split(';').map(|part| part.trim().to_ascii_lowercase());
        if parts.next().as_deref() != Some("text/csv") {
            continue;
        }
        let Some(name) =
            parts.find_map(|part| part.strip_prefix("decimal=").map(|name| name.trim_matches('"').to_owned()))
        else {
            continue;
        };
        let decimal = Decimal::ALL.iter().find(|(known, _)| *known == name).map(|(_, decimal)| *decimal);
        let detail = "The parameter decimal of text/csv is point or comma.".to_owned();
        return decimal.ok_or_else(|| ApiError::new(ProblemCode::NotAcceptable, detail));
    }
    Ok(Decimal::Point)
}

/// Middleware of paths with JSON responses only.
pub(crate) async fn json_only(request: Request, next: Next) -> Response {
    require(&["application/json"], request, next).await
}

/// Middleware of paths with event streams only.
pub(crate) async fn event_stream_only(request: Request, next: Next) -> Response {
    require(&["text/event-stream"], request, next).await
}

async fn require(offers: &[&'static str], request: Request, next: Next) -> Response {
    match negotiate(request.headers(), offers) {
        Ok(_) => next.run(request).await,
        Err(error) => error.into_response(),
    }
}

/// The media ranges of `Accept` with their quality values.
fn media_ranges(headers: &HeaderMap) -> Vec<(String, f32)> {
    let lines = headers.get_all(ACCEPT).into_iter().filter_map(|value| value.to_str().ok());
    let members = lines.flat_map(|line| line.split(',')).filter(|member| !member.trim().is_empty());
    members
        .map(|member| {
            let mut parts = member.split(';').map(str::trim);
            let range = parts.next().unwrap_or_default().to_ascii_lowercase();
            let quality = parts.find_map(|part| part.strip_prefix("q=")).and_then(|text| text.parse().ok());
            (range, quality.unwrap_or(1.0))
        })
        .collect()
}

/// Quality of an offer: that of the most specific media range that matches it, 0 without a match.
fn quality(ranges: &[(String, f32)], offer: &str) -> f32 {
    let family = offer.split_once('/').map_or(offer, |(family, _)| family);
    for candidate in [offer.to_owned(), format!("{family}/*"), "*/*".to_owned()] {
        if let Some((_, quality)) = ranges.iter().find(|(range, _)| *range == candidate) {
            return *quality;
        }
    }
    0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn choice(accept: &str) -> Option<&'static str> {
        let mut headers = HeaderMap::new();
        headers.insert(ACCEPT, accept.parse().unwrap());
        negotiate(&headers, &["application/json", "text/csv"]).ok()
    }

    #[test]
    fn the_offer_with_the_highest_quality_is_selected() {
        assert_eq!(choice("*/*"), Some("application/json"));
        assert_eq!(choice("text/csv"), Some("text/csv"));
        assert_eq!(choice("text/*"), Some("text/csv"));
        assert_eq!(choice("application/json;q=0.2, text/csv"), Some("text/csv"));
        assert_eq!(choice("text/html, */*;q=0.1"), Some("application/json"));
        assert_eq!(choice("application/json;q=0, */*"), Some("text/csv"));
        assert_eq!(choice("image/png"), None);
        assert_eq!(negotiate(&HeaderMap::new(), &["application/json"]).ok(), Some("application/json"));
    }

    #[test]
    fn f12_the_decimal_sign_of_csv_is_a_parameter_of_its_media_type() {
        for (accept, expected) in [
            ("text/csv", Some(Decimal::Point)),
            ("text/csv; decimal=point", Some(Decimal::Point)),
            ("text/csv; decimal=comma", Some(Decimal::Comma)),
            ("Text/CSV;Decimal=\"comma\";q=0.9, */*;q=0.1", Some(Decimal::Comma)),
            ("application/json;q=0.1, text/csv;header=present;decimal=comma", Some(Decimal::Comma)),
            ("text/csv;decimal=period", None),
        ] {
            let mut headers = HeaderMap::new();
            headers.insert(ACCEPT, accept.parse().unwrap());
            assert_eq!(accepted_decimal(&headers).ok(), expected, "{accept}");
        }
    }
}
