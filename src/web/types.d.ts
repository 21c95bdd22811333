// Types of the pages' scripts: what the API answers (generated from openapi/openapi.json by scripts/check-pages),
// what is known of plotly.js, and what the scripts pass to each other.

import type { components } from "../../target/page-types/openapi";

type Schemas = components["schemas"];

declare global {
  // Answers of the API, by the names of their schemas.
  type Job = Schemas["Job"];
  type JobList = Schemas["JobList"];
  type KindList = Schemas["KindList"];
  type JobResult = Schemas["JobResult"];
  type JobState = Schemas["State"];
  type Accuracy = Schemas["Accuracy"];
  type CampbellDiagram = Schemas["Campbell"];
  type CheckedDocument = Schemas["Checked"];
  type GearData = Schemas["GearData"];
  type Geometry = Schemas["Geometry"];
  type ImportedModel = Schemas["Import"];
  type ImpactResult = Schemas["Impact"];
  type MeshResult = Schemas["Mesh"];
  type MeshCurve = Schemas["MeshCurve"];
  type FlankLoad = Schemas["FlankLoad"];
  type NaturalMode = Schemas["NaturalMode"];
  type Numerics = Schemas["Numerics"];
  type PairDrawing = Schemas["Drawing"];
  type PerHalf = Schemas["PerHalf"];
  type PointColumns = Schemas["PointColumns"];
  type ProblemBody = Partial<Schemas["Problem"]>;
  type ResponseResult = Schemas["Response"];
  type BearingForce = Schemas["BearingForceResult"];
  type Rotor = Schemas["Rotor"];
  type RotorMode = Schemas["RotorMode"];
  type ShaftsResult = Schemas["Shafts"];
  type SectionDrawing = Schemas["Section"];
  type SeriesChannel = Schemas["Series"];
  /** Values that are not finite are null. */
  type SeriesData = Omit<Schemas["SeriesData"], "y"> & { y: (number | null)[] };
  type SweepResult = Schemas["Sweep"];
  type SystemState = Schemas["System"];
  type Machine = Schemas["Machine"];
  type Chunk = Schemas["Chunk"];
  type WaitingWork = Schemas["WaitingWork"];
  type Optimisation = Schemas["Optimisation"];
  type ToleranceStudy = Schemas["ToleranceStudy"];
  type MeasureScatter = Schemas["MeasureScatter"];
  type InputSensitivity = Schemas["InputSensitivity"];
  type Violation = Schemas["Violation"];
  type WarningEntry = Schemas["WarningEntry"];

  /**
   * A job document. Its parts are open: documents stored by earlier versions, and unfinished ones in the form, lack
   * some.
   */
  type JobInput = any;

  /** What a file leaves to whoever imports it: query parameters of POST /api/v1/import. */
  interface ImportChoices {
    pair?: number;
    mirror?: boolean;
    gap_mm?: number;
    torque_nm?: number;
    point?: number | string;
  }

  /** Text or a node that is put into an element; nothing stands for no child. */
  type Child = Node | string | number | null | undefined;

  /** A result as the page of a job shows it, with its document and its recorded channels. */
  interface JobContext {
    id: string;
    job: Job;
    result: JobResult;
    input: JobInput;
    catalogue: SeriesChannel[];
    /** Null where the pair of an old document is refused by this version. */
    gearData: GearData | null;
  }

  /** A job in a comparison, as far as it is read, and its line in every figure. */
  interface ComparedJob {
    id: string;
    job: Job | null;
    input?: JobInput;
    result?: JobResult;
    channels?: SeriesChannel[];
    sweep?: { grid: import("./assets/sweep/axes.js").Grid; data: import("./assets/sweep/data.js").SweepData };
    slot: number;
    letter: string;
    name: string;
    short: string;
    mark: () => HTMLElement;
  }

  /** Filters and page of the list of jobs. */
  interface ListView {
    states: string[];
    kind: string;
    label: string;
    /** Part of name, label or notes. */
    search: string;
    /** First and last day of submission, in the local calendar. */
    from: string;
    to: string;
    /** What the list is sorted by and its direction: "name-asc". */
    sort: string;
    /** Jobs on a page. */
    limit: number;
    cursor: string;
    /** Cursors of the pages before this one, as far as they were visited. */
    trail: string[] | null;
  }

  /** A sweep as its page has read it. */
  interface SweepState {
    id: string;
    name: string;
    data: import("./assets/sweep/data.js").SweepData;
    quantities: SweepQuantity[];
    /** The result without its rows; null until the sweep has succeeded. */
    rest: JobResult | null;
    /** Mesh orders of the recorded spectra. */
    orders: number[] | null;
  }

  /** The view of a sweep that is chosen. */
  interface SweepView {
    grid: import("./assets/sweep/axes.js").Grid;
    name: string;
    quantity: SweepQuantity;
    /** Name of the kind of motion or contact shown by a map in place of the quantity. */
    kind: string | null;
    state: { name: string; label: string; unit: string; scale: number };
    /** Index of the value of the second axis. */
    line: number;
    /** Index of the branch. */
    branch: number;
    halves: "both" | "left" | "right";
    log: boolean;
    contours: boolean;
    hertz: boolean;
    resonances: boolean;
    /** Range of the first axis; null for all of it. */
    range: number[] | null;
    /** Position of the selected point. */
    selected: number | null;
    click: (event: any) => void;
  }

  /** A quantity of the points: its columns by half, or one for the pair; of `least` quantities less is better. */
  interface SweepQuantity {
    name: string;
    label: string;
    unit: string;
    least: boolean;
    /** Only points of documents with shafts have it. */
    needsShafts: boolean;
    change: import("./assets/common/quantities.js").Quantity["change"];
    columns: { both?: string; left?: string; right?: string };
  }

  /** A kind of motion or contact; `colour` is a variable of the stylesheet. */
  interface PointKind {
    is: (word: string) => boolean;
    label: string;
    detail: string;
    colour: string;
  }

  /** A trace of plotly.js, and what plot_style.js takes from it: see plot_traces.js. */
  type Trace = Record<string, any>;

  /** A title with its unit after the last comma ("Time, s"), or both apart. */
  type AxisTitle = string | { label?: string; unit?: string };

  /** Both ends of a range of values. */
  type Span = [number, number];

  /** A row of a list of values: term, value, unit, meaning. */
  type ValueRow = [Child, Child, string?, Explained?];

  /** What a "?" shows: the meaning of a number, and the section of the theory pages (page and heading). */
  interface Explained {
    help: string;
    theory: string;
  }

  /** Axes of a plot, and what is drawn beside its traces. */
  interface PlotAxes {
    x?: AxisTitle;
    y?: AxisTitle;
    /** Part of the height that the y axis takes; all if left out. */
    yPart?: number;
    /** A second axis on the right; traces name it by `yaxis: "y2"`. */
    y2?: AxisTitle;
    /** Quantity of a heat map, for its table. */
    z?: string;
    /** Name of the plot for screen readers and files; the figure's caption or heading if left out. */
    name?: string;
    /** Title inside the plot. */
    title?: string;
    /** Quantity of the y axis where that has its unit alone; the plot's name if left out. For images. */
    quantity?: string;
    /** What an image is of beside its name: the page's heading if left out. */
    subject?: string;
    /** Colours that the page explains beside the plot: entries of the legend of an image. */
    keys?: PlotKey[];
    /** Name of its files without ending. */
    csvName?: string;
    /** Ends of the axes; of all data if left out. */
    range?: number[];
    yRange?: number[];
    y2Range?: number[];
    /** The y axis is logarithmic. */
    log?: boolean;
    /** Areas between two curves. */
    bands?: { x: number[]; low: number[]; high: number[]; name?: string; colour?: number }[];
    /** Vertical lines. */
    marks?: { x: number; text?: string; at?: number; dash?: string; colour?: string }[];
    /** Horizontal lines. */
    levels?: { y: number; text?: string; dash?: string }[];
    /** A second x axis above, `factor` times the first. */
    top?: { title: string; factor: number };
    /** Both axes start at zero. */
    fromZero?: boolean;
    /** A unit is as long on both axes. */
    equal?: boolean;
    /** Dragging zooms x only. */
    zoomX?: boolean;
    /** Plots with the same word zoom x together. */
    link?: string;
    /** Chosen by the traces if left out. */
    hover?: "closest" | "x unified";
    /** Passed on to plotly.js. */
    shapes?: Record<string, any>[];
    annotations?: Record<string, any>[];
    layout?: Record<string, any>;
    /** Called last with the layout, the colours of the stylesheet by name, and the size in pixels. */
    more?: (layout: any, colour: (name: string) => string, size: { width: number; height: number }) => void;
    /** Called with plotly's event when a point is clicked. */
    click?: (event: any) => void;
  }

  /** A colour of the stylesheet ("--regime-1") and its meaning. */
  interface PlotKey {
    label: string;
    colour: string;
  }

  interface Plot {
    traces: Trace[];
    axes: PlotAxes;
  }

  interface Window {
    /** plotly.js, once its script is loaded. */
    Plotly: any;
  }
}
