// The client of the HTTP API. Every failure becomes a Problem.

const BASE = "/api/v1";

/** A failed request: `problem` is the problem+json body, made up where the server gave none. */
export class Problem extends Error {
  constructor(problem) {
    super(problem.title ?? "The request failed");
    this.problem = problem;
    this.status = problem.status ?? 0;
    this.errors = problem.errors ?? [];
  }
}

async function request(method, path, { body, headers = {}, signal, base = BASE } = {}) {
  const options = { method, headers: { Accept: "application/json, application/problem+json", ...headers }, signal };
  if (body !== undefined) {
    options.body = JSON.stringify(body);
    options.headers["Content-Type"] = "application/json";
  }
  let response;
  try {
    response = await fetch(base + path, options);
  } catch (error) {
    if (error.name === "AbortError") throw error;
    throw new Problem({ title: "The server does not answer", status: 0, code: "unreachable" });
  }
  if (response.ok) return response.status === 204 ? null : response.json();
  let problem;
  try {
    problem = await response.json();
  } catch {
    problem = { title: `The server answered with status ${response.status}` };
  }
  if (response.status === 401) logIn();
  throw new Problem({ ...problem, status: response.status });
}

/** The session has ended: to the login page, and back here. */
function logIn() {
  const here = window.location.pathname + window.location.search;
  window.location.assign(`/login?${new URLSearchParams({ next: here })}`);
}

const at = (id) => `/jobs/${encodeURIComponent(id)}`;

function query(parameters) {
  const given = Object.entries(parameters).filter(([, value]) => value !== undefined && value !== null && value !== "");
  return given.length ? `?${new URLSearchParams(given)}` : "";
}

/** Checks a document; with `drawing` the answer has what a drawing of the pair needs. */
export const validate = (document, { drawing, signal } = {}) =>
  request("POST", `/jobs/validate${query({ drawing })}`, { body: document, signal });
export const presets = () => request("GET", "/assets/presets.json", { base: "" });
export const submit = (document, key) =>
  request("POST", "/jobs", { body: document, headers: { "Idempotency-Key": key } });
export const jobs = (parameters, signal) => request("GET", `/jobs${query(parameters)}`, { signal });
export const kinds = () => request("GET", "/kinds");
export const job = (id) => request("GET", at(id));
export const cancel = (id) => request("POST", `${at(id)}/cancel`);
export const remove = (id) => request("DELETE", at(id));
export const input = (id) => request("GET", inputUrl(id).slice(BASE.length));
export const result = (id) => request("GET", resultUrl(id).slice(BASE.length));
export const catalogue = (id) => request("GET", `${at(id)}/series`);
export const series = (id, channel, parameters, signal) =>
  request("GET", `${at(id)}/series/${encodeURIComponent(channel)}${query(parameters)}`, { signal });

/** The result of a sweep without its rows, which may be many megabytes. */
export const resultWithoutRows = (id) => request("GET", `${at(id)}/result?rows=false`);
export const points = (id, parameters, signal) => request("GET", `${at(id)}/points${query(parameters)}`, { signal });
export const pointColumns = (id, parameters, signal) => request("GET", `${at(id)}/points/columns${query(parameters)}`, { signal });
export const pointInput = (id, position) => request("GET", `${at(id)}/points/${position}/input`);

export const inputUrl = (id) => `${BASE}${at(id)}/input`;
export const resultUrl = (id) => `${BASE}${at(id)}/result`;
export const seriesUrl = (id, channel) => `${BASE}${at(id)}/series/${encodeURIComponent(channel)}`;
export const submitUrl = () => `${window.location.origin}${BASE}/jobs`;

export const isEnded = (job) => ["succeeded", "failed", "canceled"].includes(job.state);

/** A new idempotency key; `crypto.randomUUID` exists only on secure origins. */
export function newKey() {
  const bytes = crypto.getRandomValues(new Uint8Array(16));
  return [...bytes].map((byte) => byte.toString(16).padStart(2, "0")).join("");
}

/** Where the CSV file of a whole channel is; `decimal` is "point" or "comma". */
export const seriesCsvUrl = (id, channel, decimal) => `${seriesUrl(id, channel)}?method=none&decimal=${decimal}`;

/** The CSV file of a whole channel. */
export const seriesCsv = (id, channel, decimal) => csv(seriesCsvUrl(id, channel, decimal));

/** The CSV file of all points of a sweep, as far as they are solved. */
export const pointsCsv = (id, decimal) => csv(`${BASE}${at(id)}/points?decimal=${decimal}`);

async function csv(address) {
  const response = await fetch(address, { headers: { Accept: "text/csv" } });
  if (response.status === 401) logIn();
  if (!response.ok) throw new Problem({ title: `The server answered with status ${response.status}`, status: response.status });
  // As text it would lose its byte order mark.
  return response.blob();
}
