// Types of the module that the service makes from the declarations of its results (src/web/quantities.rs).

/** A number, word or flag of a result, or of gear data. */
export interface Quantity {
  /** JSON pointer in the answer; `{half}` in it stands for `left` and `right`. */
  pointer: string;
  /** In lower case. */
  label: string;
  /** Symbol with its index after an underscore, or empty. */
  symbol: string;
  /** In ASCII, or empty. */
  unit: string;
  help: string;
  /** Section of the theory pages: page and heading. */
  theory: string;
  kind: "number" | "word" | "flag";
  /** The value is a share of 1 that is shown in per cent. */
  percent: boolean;
  /**
   * How the difference of two values is written: in `percent`, as a `level` as well, in percentage `points`,
   * `absolute` or not at all.
   */
  change: "percent" | "level" | "points" | "absolute" | "none";
  lower_is_better: boolean;
}

/** A column of the rows of a sweep. */
export interface SweepColumn {
  name: string;
  /** The same for the columns of both halves. */
  group: string;
  /** Pointer of the quantity that it holds; null where the sweep itself makes the value. */
  quantity: string | null;
  half: "left" | "right" | null;
  kind: "number" | "word" | "numbers";
  /** Only in answers that name it. */
  on_request: boolean;
}

export const QUANTITIES: Quantity[];
/** Of the answer `GearData`. */
export const GEAR_DATA: Quantity[];
export const SWEEP_COLUMNS: SweepColumn[];
