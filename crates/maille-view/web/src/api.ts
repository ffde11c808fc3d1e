// The server, or the data of a bundle.

import type {
  Change,
  Export,
  Judged,
  Measure,
  New,
  Pair,
  Refused,
  Save,
  Shown,
  Solve,
  SolveEvent,
  Start,
  Subject,
  Text,
} from "./types";

/** What the server refused. */
export class Refusal extends Error {
  constructor(
    readonly status: number,
    readonly refused: Refused,
  ) {
    super(refused.problem);
  }
}

async function ask(path: string, body: unknown, signal?: AbortSignal): Promise<Response> {
  const init: RequestInit = body === undefined ? {} : { method: "POST", body: JSON.stringify(body) };
  if (signal) init.signal = signal;
  let answer: Response;
  try {
    answer = await fetch(path, init);
  } catch (error) {
    if (signal?.aborted) throw error;
    throw new Refusal(0, {
      problem: "the server does not answer",
      help: "is `maille view` still running?",
      problems: [],
    });
  }
  if (answer.ok) return answer;
  const text = await answer.text();
  let refused: Refused = { problem: `${answer.status} ${text}`.trim(), help: "", problems: [] };
  try {
    refused = JSON.parse(text) as Refused;
  } catch {
    // No JSON: the text itself says what is wrong.
  }
  throw new Refusal(answer.status, refused);
}

/** What the page starts with. */
export async function start(): Promise<Start> {
  const inside = document.getElementById("maille-data")?.textContent;
  return inside ? (JSON.parse(inside) as Start) : ((await (await ask("/api/start", undefined)).json()) as Start);
}

/** What a design has that is nothing but its text. */
export const PLAIN = { file: null, parameters: {}, map: null, simulation: null };

export async function builtin(name: string): Promise<Shown> {
  const text = (await (await ask(`/api/builtin/${encodeURIComponent(name)}`, undefined)).json()) as Text;
  return { ...PLAIN, ...text };
}
export async function record(name: string): Promise<Shown> {
  return (await ask("/api/open", { name })).json();
}
export async function measure(request: Measure): Promise<Pair[]> {
  return (await ask("/api/measure", request)).json();
}
export async function judge(subject: Subject, signal: AbortSignal): Promise<Judged> {
  return (await ask("/api/judge", subject, signal)).json();
}
/** The text of a design file with values of it changed. */
export async function edit(text: string, changes: Change[]): Promise<string> {
  return ((await (await ask("/api/edit", { text, changes })).json()) as Text).text;
}
/** A design that has no file yet. */
export async function newDesign(request: New): Promise<Shown> {
  const { name, text } = (await (await ask("/api/new", request)).json()) as Text;
  return { ...PLAIN, name: `${name}.toml`, text };
}
export async function save(request: Save): Promise<Text> {
  return (await ask("/api/save", request)).json();
}
export async function exported(request: Export): Promise<Blob> {
  return (await ask("/api/export", request)).blob();
}

/** Limits as they are found. The server stops when `signal` is aborted, for then the socket closes. */
export async function solve(request: Solve, signal: AbortSignal, hear: (event: SolveEvent) => void): Promise<void> {
  const body = (await ask("/api/solve", request, signal)).body;
  if (!body) return;
  const reader = body.pipeThrough(new TextDecoderStream()).getReader();
  let rest = "";
  for (;;) {
    const { done, value } = await reader.read();
    if (done) return;
    const events = (rest + value).split("\n\n");
    rest = events.pop() ?? "";
    for (const event of events) {
      if (event.startsWith("data: ") && !signal.aborted) hear(JSON.parse(event.slice(6)) as SolveEvent);
    }
  }
}
