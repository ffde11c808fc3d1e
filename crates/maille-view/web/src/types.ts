// Written from the Rust types by `MAILLE_BLESS=1 cargo test -p maille-view --test it types::`.

export interface Activity {
  solves: number;
}

export interface ChainRecord {
  vector: [number, number];
  length: number;
  rings: [number, [number, number]][];
}

export interface Change {
  field: string;
  value: string;
}

export interface ContactRecord {
  ring_a: number;
  ring_b: number;
  shift: [number, number];
  point_a: [number, number, number];
  point_b: [number, number, number];
  normal: [number, number, number];
  force: number;
}

export interface CurveSpec {
  shape: Shape;
  normal: [number, number, number];
  along: [number, number, number];
  offset: [number, number, number];
  minor_radius?: number | null;
}

export interface Design {
  schema: number;
  name: string;
  title: string;
  source: Source;
  unit?: string | null;
  minor_radius?: number | null;
  reference_radius: number;
  curve_tolerance?: number | null;
  allow_initial_overlap: boolean;
  lattice: LatticeSpec;
  elements: ElementSpec[];
  varied?: Record<string, number>;
  parameters?: Parameter[];
  formulas?: Record<string, string>;
}

export interface DualRecord {
  tie: string;
  rings: [number, [number, number]][];
  force: [number, number, number];
}

export interface Edit {
  text: string;
  changes: Change[];
}

export interface ElementSpec {
  name: string;
  center: [number, number, number];
  rings: RingSpec[];
  curves?: CurveSpec[];
}

export type End =
  | "reached"
  | "locked"
  | "not-converged"
  | "interrupted";

export interface Export {
  format: string;
  subject: Subject;
  tile: [number, number];
  state: StateRecord | null;
  cell: string | null;
  finite: boolean;
  rows: LimitRow[];
}

export interface Frame {
  number: number;
  share: number;
  energy: number;
  stretch: number | null;
  mean_force: number | null;
  roll: string | null;
  poses: PoseRecord[];
}

export interface Judged {
  problems: ListedProblem[];
  design: Design | null;
  sheet: Sheet | null;
}

export interface LatticeSpec {
  a1: [number, number, number];
  a2: [number, number, number];
  single?: boolean;
}

export interface Limit {
  row: LimitRow;
  state: StateRecord;
  pairs: Pair[];
}

export interface LimitRow {
  design: string;
  minor_radius: number | null;
  direction_deg: number;
  l2: number;
  method: string;
  cell: string;
  status: Status;
  l1: number | null;
  lambda1: number | null;
  lambda2: number | null;
  stretch1: number | null;
  stretch2: number | null;
  max_overlap: number | null;
  min_gap: number | null;
  iterations: number;
  runs: number;
  wall_s: number;
  bound_l1: number | null;
  bound_kind: string | null;
  bound_gap: number | null;
  dual_residual: number | null;
  complementarity: number | null;
  min_multiplier: number | null;
  min_curvature: number | null;
  zero_modes: number | null;
  links_ok: boolean | null;
  n_starts: number | null;
  n_distinct: number | null;
  own_image_force: number | null;
  l1_uncertified: number | null;
  lateral: string | null;
  shear: string | null;
  l2_min: number | null;
  l2_max: number | null;
  shear_min: number | null;
  shear_max: number | null;
  a1_x: number | null;
  a1_y: number | null;
  a2_x: number | null;
  a2_y: number | null;
  end: string | null;
  by_cell: string | null;
  image_of_deg: number | null;
  grows_with_cell: boolean | null;
  better_chance: number | null;
  wave_curvature: number | null;
  wave_q1: number | null;
  wave_q2: number | null;
  extreme: string | null;
}

export interface Listed {
  name: string;
  title: string;
}

export interface ListedProblem {
  field: string | null;
  problem: string;
  help: string | null;
  line: number | null;
  column: number | null;
}

export interface Measure {
  subject: Subject;
  cell: string;
  finite: boolean;
  a1: [number, number, number];
  a2: [number, number, number];
  poses: PoseRecord[];
}

export interface New {
  name: string;
  weave: string | null;
  major: number;
  minor: number;
  unit: string;
}

export interface OpenRecord {
  name: string;
}

export interface Pair {
  ring_a: number;
  ring_b: number;
  shift: [number, number];
  number: number;
  gap: number;
}

export interface Palette {
  kinds: string[];
  loads: string[];
  unloaded: string;
  force: string;
}

export interface Parameter {
  name: string;
  value: number;
  formula?: string | null;
  min?: number | null;
  max?: number | null;
}

export interface PathPart {
  to: [number, number, number];
  through: [number, number, number] | null;
}

export interface PoseRecord {
  element: string;
  position: [number, number, number];
  rotation: [number, number, number, number];
}

export interface Refused {
  problem: string;
  help: string;
  problems: ListedProblem[];
}

export interface Ring {
  element: number;
  offset: [number, number, number];
  normal: [number, number, number];
  major_radius: number;
  minor_radius: number;
  curve?: [number, number, number][] | null;
  open: boolean;
}

export interface RingSpec {
  major_radius: number;
  normal: [number, number, number];
  offset: [number, number, number];
  minor_radius?: number | null;
}

export interface RollRecord {
  along: [number, number];
  turn_rad: [number, number];
}

export interface Save {
  file: string;
  text: string;
  overwrite: boolean;
}

export type Shape =
  | { "stadium": { straight: number; radius: number } }
  | { "square": { side: number; fillet: number } }
  | { "hexagon": { side: number; fillet: number } }
  | { "polyline": { points: [number, number, number][]; fillet: number; closed?: boolean } }
  | { "path": { from?: [number, number, number] | null; parts: PathPart[] } }
  | { "spline": { points: [number, number, number][]; closed?: boolean } }
  | { "frame": { vertices: [number, number, number][]; edges: [number, number][] } }
  | { "ellipse": { a: number; b: number } }
  | { "torus_knot": { p: number; q: number; R: number; a: number } };

export interface Sheet {
  name: string;
  title: string;
  unit: string | null;
  cell: string;
  reference_radius: number;
  a1: [number, number, number];
  a2: [number, number, number];
  kinds: number[];
  first_ring: number[];
  poses: PoseRecord[];
  rings: Ring[];
  pairs: Pair[];
}

export interface Shown {
  name: string;
  file: string | null;
  text: string;
  parameters: Record<string, number>;
  map: ShownMap | null;
  simulation: ShownSimulation | null;
}

export interface ShownMap {
  source: string;
  sheets: Sheet[];
  limits: Limit[];
}

export interface ShownSimulation {
  source: string;
  sheet: Sheet;
  frames: Frame[];
  total: number;
  end: End;
  note: string | null;
}

export interface Solve {
  slot: string;
  subject: Subject;
  directions_deg: number[];
  l2: number[];
  lateral_free: boolean;
}

export type SolveEvent =
  | { "begun": number }
  | { "sheet": Sheet }
  | { "limit": Limit }
  | { "ended": { cancelled: boolean } }
  | { "failed": Refused };

export type Source =
  | "thesis-text"
  | "reconstruction"
  | "literature"
  | "own";

export interface Start {
  version: string;
  designs: Listed[];
  records: Listed[];
  weaves: string[];
  opened: Shown;
  palette: Palette;
  bundle: boolean;
}

export interface StateRecord {
  direction_deg: number;
  l2: number;
  status: Status;
  a1: [number, number, number];
  a2: [number, number, number];
  roll?: RollRecord | null;
  deformation_gradient: [[number, number], [number, number]];
  poses: PoseRecord[];
  residual: number | null;
  note?: string | null;
  contacts?: ContactRecord[];
  chain?: ChainRecord | null;
  dual?: DualRecord[];
  steps?: StepRecord[];
}

export type Status =
  | "global"
  | "local"
  | "threshold-reached"
  | "uncertified"
  | "l2-unreachable"
  | "l2-not-reached"
  | "unbounded"
  | "not-converged"
  | "infeasible-start"
  | "interrupted";

export interface StepRecord {
  run: number;
  l1: number;
  energy: number;
  size: number;
  perturbed: boolean;
  wall_s: number;
}

export interface Subject {
  name: string;
  text: string;
  minor_radius: number | null;
  spacing: number | null;
  parameters: Record<string, number>;
}

export interface Text {
  name: string;
  text: string;
}
