// What `recollect experiment paper` writes into the page (src/recollect/evaluation/run_json.h).

export interface Estimate {
  value: number;
  low: number;
  high: number;
}

export interface Row {
  name: string;
  label: string;
  frames: number;
  availability: number;
  mean: Estimate;
  median: Estimate;
  p95: Estimate;
  p75: number;
  max: number;
  box: { low: number; q1: number; median: number; q3: number; high: number };
  heading_deg?: { median: number; p95: number };
}

export interface Accuracy {
  name: string;
  learnt: number;
  live: number;
  within_labels: (Estimate & { allowed: number })[];
  within_frames: (Estimate & { allowed: number })[];
}

export interface CurvePoint {
  step: number;
  loss: number;
  train_position_m?: number | null;
  valid_position_m: number;
}

export interface Frames {
  frame: number[];
  distance_m: number[];
  key_frame: number[];
  nearest_key_frame: number[];
  place: number[];
  confidence: number[];
  state: string[];
  carried_by: string[];
  support: number[];
  votes: [number, number][][]; // key frame and its votes, most first
  truth: [number, number][];
  estimate: [number, number][];
  errors: Record<string, (number | null)[]>;
}

export interface Run {
  title: string;
  images: 'rendered' | 'real';
  notes: string[];
  stamp: {
    command: string;
    seed: number;
    data_hash: string;
    versions: Record<string, string>;
  };
  dataset: {
    laps: {
      name: string;
      role: string;
      frames: number;
      at_1m: number;
      at_5m: number;
      length_m: number;
    }[];
    key_frames: number;
    spacing_m: number;
    recogniser: string;
    published?: {
      gps: { available: number; mean_m: number; median_m: number; p75_m: number };
      laps: { lap: string; name: string; rows: number; at_1m: number; at_5m: number }[];
      registration: { classes: number; train: number; test: number };
      pairs: { train: number; valid: number; test: number };
      baselines: {
        nearest_all_mean_m: number;
        nearest_one_lap_mean_m: number;
        no_motion_mean_m: number;
      };
    };
  };
  places: { count: number; spacing_m: number; systems: Accuracy[] };
  training: {
    network: string;
    parameters: number;
    laps: string[];
    steps: number;
    seconds: number;
    trained_here: boolean;
    validated_on: string;
    validation_mean_m: number;
    no_motion_mean_m: number;
    curve: CurvePoint[];
  } | null;
  segments: { metres: number; count: number; resamples: number };
  rows: Row[];
  good_retrieval: { within_m: number; share: number; rows: Row[] };
  paired: { a: string; b: string; frames: number; difference: Estimate }[];
  states?: Record<string, number>;
  trust?: Record<string, number>;
  latency_ms: Record<string, { p50: number; p99: number }>;
  frames: Frames;
  keys: { at: [number, number][]; lap: string[]; frame: number[] };
  axes: [string, string];
}

export interface Images {
  live: string[]; // base64 JPEG, one a frame of Run.frames
  keys: Record<string, string>; // by key frame
}

function parse<T>(id: string): T | null {
  return JSON.parse(document.getElementById(id)?.textContent ?? 'null') as T | null;
}

export const loadRun = (): Run | null => parse<Run>('report-data');

// Most of the file's bytes: read when the first image is wanted.
let images: Images | null | undefined;
export function loadImages(): Images | null {
  if (images === undefined) images = parse<Images>('report-images');
  return images;
}
