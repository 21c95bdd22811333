// The client of the HTTP API. Every failure becomes a Problem.

const BASE = "/api/v1";

/** A failed request: `problem` is the problem+json body, made up where the server gave none. */
export class Problem extends Error {
  /** @param {ProblemBody} problem */
  constructor(problem) {
    super(problem.title ?? "The request failed");
    this.problem = problem;
    this.status = problem.status ?? 0;
    this.errors = problem.errors ?? [];
  }
}

/**
 * @typedef {{ body?: unknown, file?: Blob, headers?: Record<string, string>, signal?: AbortSignal, base?: string }}
 * RequestOptions `file` is a body of its own
 */

/**
 * @param {string} method
 * @param {string} path
 * @param {RequestOptions} [options]
 * @returns {Promise<any>} the JSON of the answer
 * @throws {Problem}
 */
async function request(method, path, { body, file, headers = {}, signal, base = BASE } = {}) {
  /** @type {RequestInit & { headers: Record<string, string> }} */
  const options = { method, headers: { Accept: "application/json, application/problem+json", ...headers }, signal };
  if (body !== undefined) {
    options.body = JSON.stringify(body);
    options.headers["Content-Type"] = "application/json";
  }
  if (file) {
    options.body = file;
    options.headers["Content-Type"] = "application/octet-stream";
  }
  let response;
  try {
    response = await fetch(base + path, options);
  } catch (error) {
    if (error instanceof DOMException && error.name === "AbortError") throw error;
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

/** @param {string} id */
const at = (id) => `/jobs/${encodeURIComponent(id)}`;

/** @param {Record<string, any>} parameters those without a value are left out */
function query(parameters) {
  const given = Object.entries(parameters).filter(([, value]) => value !== undefined && value !== null && value !== "");
  return given.length ? `?${new URLSearchParams(given)}` : "";
}

/**
 * Checks a document; with `drawing` the answer contains the data of a drawing of the pair.
 * @type {(document: JobInput, options?: { drawing?: boolean, signal?: AbortSignal }) => Promise<CheckedDocument>}
 */
export const validate = (document, { drawing, signal } = {}) =>
  request("POST", `/jobs/validate${query({ drawing })}`, { body: document, signal });
/** @type {() => Promise<{ id: string, title: string, about: string, document: JobInput }[]>} */
export const presets = () => request("GET", "/assets/presets.json", { base: "" });
/**
 * Makes a job document of a gear model of another program; nothing is submitted.
 * @type {(file: Blob, choices?: ImportChoices) => Promise<ImportedModel>}
 */
export const importModel = (file, choices = {}) => request("POST", `/import${query(choices)}`, { file });
/** @type {(document: JobInput, key: string) => Promise<Job>} */
export const submit = (document, key) =>
  request("POST", "/jobs", { body: document, headers: { "Idempotency-Key": key } });
/** @type {(parameters: Record<string, any>, signal?: AbortSignal) => Promise<JobList>} */
export const jobs = (parameters, signal) => request("GET", `/jobs${query(parameters)}`, { signal });
/** @type {() => Promise<SystemState>} */
export const system = () => request("GET", "/system");
/** @type {() => Promise<KindList>} */
export const kinds = () => request("GET", "/kinds");
/** @type {(id: string) => Promise<Job>} */
export const job = (id) => request("GET", at(id));
/**
 * Changes name, label or notes of a job; null removes a text.
 * @type {(id: string, patch: { name?: string | null, label?: string | null, notes?: string | null }) => Promise<Job>}
 */
export const update = (id, patch) => request("PATCH", at(id), { body: patch });
/** @type {(id: string) => Promise<Job>} */
export const cancel = (id) => request("POST", `${at(id)}/cancel`);
/** @type {(id: string) => Promise<null>} */
export const remove = (id) => request("DELETE", at(id));
/** @type {(id: string) => Promise<JobInput>} */
export const input = (id) => request("GET", inputUrl(id).slice(BASE.length));
/** @type {(id: string) => Promise<JobResult>} */
export const result = (id) => request("GET", resultUrl(id).slice(BASE.length));
/**
 * The gear data of a job's pair (ISO 21771), calculated from its document.
 * @type {(id: string) => Promise<GearData>}
 */
export const gearData = (id) => request("GET", `${at(id)}/gear-data`);
/** @type {(id: string) => Promise<{ items: SeriesChannel[] }>} */
export const catalogue = (id) => request("GET", `${at(id)}/series`);
/**
 * @type {(id: string, channel: string, parameters: Record<string, any>, signal?: AbortSignal) => Promise<SeriesData>}
 */
export const series = (id, channel, parameters, signal) =>
  request("GET", `${at(id)}/series/${encodeURIComponent(channel)}${query(parameters)}`, { signal });

/**
 * The result of a sweep without its rows, which may be many megabytes.
 * @type {(id: string) => Promise<JobResult>}
 */
export const resultWithoutRows = (id) => request("GET", `${at(id)}/result?rows=false`);
/** @type {(id: string, parameters: Record<string, any>, signal?: AbortSignal) => Promise<PointColumns>} */
export const pointColumns = (id, parameters, signal) => request("GET", `${at(id)}/points/columns${query(parameters)}`, { signal });
/** @type {(id: string, position: number) => Promise<JobInput>} */
export const pointInput = (id, position) => request("GET", `${at(id)}/points/${position}/input`);

/** @param {string} id */
export const inputUrl = (id) => `${BASE}${at(id)}/input`;
/** The pair as a REXS model. @param {string} id */
export const rexsUrl = (id) => `${BASE}${at(id)}/rexs`;
/** @param {string} id */
export const resultUrl = (id) => `${BASE}${at(id)}/result`;
/** @type {(id: string, channel: string) => string} */
const seriesUrl = (id, channel) => `${BASE}${at(id)}/series/${encodeURIComponent(channel)}`;
export const submitUrl = () => `${window.location.origin}${BASE}/jobs`;

/** @param {Job} job */
export const isEnded = (job) => ["succeeded", "failed", "canceled"].includes(job.state);

/** A new idempotency key; `crypto.randomUUID` exists only on secure origins. */
export function newKey() {
  const bytes = crypto.getRandomValues(new Uint8Array(16));
  return [...bytes].map((byte) => byte.toString(16).padStart(2, "0")).join("");
}

/**
 * Address of the CSV file of a whole channel; `decimal` is "point" or "comma".
 * @type {(id: string, channel: string, decimal: string) => string}
 */
export const seriesCsvUrl = (id, channel, decimal) => `${seriesUrl(id, channel)}?method=none&decimal=${decimal}`;

/**
 * Address of the file of all channels; `format` is "npz" or "mat".
 * @type {(id: string, format: string) => string}
 */
export const seriesFileUrl = (id, format) => `${BASE}${at(id)}/series?format=${format}`;

/**
 * Address of the sound of an acceleration.
 * @type {(id: string, channel: string) => string}
 */
export const soundUrl = (id, channel) => `${seriesUrl(id, channel)}.wav`;

/**
 * The CSV file of a whole channel.
 * @type {(id: string, channel: string, decimal: string) => Promise<Blob>}
 */
export const seriesCsv = (id, channel, decimal) => csv(seriesCsvUrl(id, channel, decimal));

/**
 * The CSV file of all points of a sweep that are solved.
 * @type {(id: string, decimal: string) => Promise<Blob>}
 */
export const pointsCsv = (id, decimal) => csv(`${BASE}${at(id)}/points?decimal=${decimal}`);

/** @param {string} address */
async function csv(address) {
  const response = await fetch(address, { headers: { Accept: "text/csv" } });
  if (response.status === 401) logIn();
  if (!response.ok) throw new Problem({ title: `The server answered with status ${response.status}`, status: response.status });
  // As text it would lose its byte order mark.
  return response.blob();
}
