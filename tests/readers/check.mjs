// Holds a recording against the JavaScript readers `@mcap/core` and `@mcap/support` (with `protobufjs`).
//
//     node check.mjs RECORDING.mcap
//
// Prints one line per check. Exit code 0: all hold; 1: at least one does not; 2: there is no such file.
// What a recording must hold stands in `layout.json`, which check.py reads too. Nothing here knows the program
// that wrote the file: messages are decoded by the descriptors that the recording carries. These readers
// verify the CRCs of chunks, attachments and the summary, but not that of the data section; check.py does.

import { readFileSync } from "node:fs";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { loadDecompressHandlers, protobufFromBinaryDescriptor } from "@mcap/support";

const layout = JSON.parse(readFileSync(new URL("layout.json", import.meta.url), "utf8"));

let failed = 0;

/** One check: it holds if there are no problems. The first few problems are printed. */
function hold(name, problems, detail = "") {
  if (problems.length > 0) {
    failed += 1;
    const more = problems.length > 3 ? ` (and ${problems.length - 3} more)` : "";
    console.log(`FAIL ${name}: ${problems.slice(0, 3).join("; ")}${more}`);
  } else {
    console.log(`ok   ${name}${detail ? ": " : ""}${detail}`);
  }
}

/** Everything in the file, in its order; the reader verifies the CRCs of chunks and attachments on the way. */
function readInOrder(content, decompressHandlers) {
  const reader = new McapStreamReader({ decompressHandlers, includeChunks: true, validateCrcs: true });
  reader.append(content);
  const found = { channels: new Map(), messages: [], attachments: [], metadata: [], chunks: [] };
  for (let record; (record = reader.nextRecord()); ) {
    switch (record.type) {
      case "Header":
        found.header = record;
        break;
      case "Channel":
        found.channels.set(record.id, record);
        break;
      case "Message":
        found.messages.push(record);
        break;
      case "Attachment":
        found.attachments.push(record);
        break;
      case "Metadata":
        found.metadata.push(record);
        break;
      case "Chunk":
        found.chunks.push(record);
        break;
      case "DataEnd":
        found.dataEnd = record;
        break;
      case "Footer":
        found.footer = record;
        break;
    }
  }
  if (!reader.done()) {
    throw new Error("the file ends before its footer");
  }
  return found;
}

/** The content of the file as the indexed reader wants it. */
function readable(content) {
  return {
    size: async () => BigInt(content.byteLength),
    read: async (offset, size) => {
      const end = Number(offset + size);
      if (end > content.byteLength) {
        throw new Error(`bytes ${offset} to ${end} lie beyond the end`);
      }
      return content.slice(Number(offset), end);
    },
  };
}

async function collect(records) {
  const all = [];
  for await (const record of records) {
    all.push(record);
  }
  return all;
}

function checkCrcs(recording) {
  const problems = recording.chunks.flatMap((chunk, index) =>
    chunk.uncompressedCrc === 0 ? [`chunk ${index} has no CRC`] : [],
  );
  if (recording.dataEnd.dataSectionCrc === 0) {
    problems.push("the data section has no CRC");
  }
  if (recording.footer.summaryCrc === 0) {
    problems.push("the summary has no CRC");
  }
  hold("CRCs", problems, `${recording.chunks.length} chunks, summary, attachments`);
}

/** What stands around the messages: profile, library, metadata, the scene. */
function checkAround(recording) {
  const { profile, library } = recording.header;
  const missing = [profile ? [] : ["no profile"], library ? [] : ["no library"]].flat();
  hold("header", missing, `profile \`${profile}\`, library \`${library}\``);

  const late = recording.messages.flatMap((message, index) =>
    index > 0 && message.logTime < recording.messages[index - 1].logTime
      ? [`message ${index} is earlier than the one before`]
      : [],
  );
  hold("log times never decrease", late);

  const names = recording.metadata.map((record) => record.name);
  const problems = layout.required_metadata
    .filter((pattern) => !names.some((name) => new RegExp(pattern).test(name)))
    .map((pattern) => `no metadata ${pattern}`);
  for (const record of recording.metadata.filter(({ name }) => name === layout.recording_metadata)) {
    problems.push(
      ...layout.recording_keys
        .filter((key) => !record.metadata.has(key))
        .map((key) => `${record.name} has no \`${key}\``),
    );
  }
  hold("metadata", problems, names.join(" "));

  const scenes = recording.attachments.filter(({ mediaType }) => mediaType === layout.scene_media_type);
  const unreadable = scenes.length > 0 ? [] : [`no attachment of type ${layout.scene_media_type}`];
  for (const scene of scenes) {
    try {
      if (new TextDecoder("utf-8", { fatal: true }).decode(scene.data).trim() === "") {
        unreadable.push(`\`${scene.name}\` is empty`);
      }
    } catch (error) {
      unreadable.push(`\`${scene.name}\`: ${error.message}`);
    }
  }
  hold("scene", unreadable, scenes.map(({ name }) => name).join(" "));
}

async function checkSummary(recording, indexed) {
  const { statistics } = indexed;
  if (statistics == undefined) {
    hold("summary", ["no statistics"]);
    return;
  }
  const counted = new Map();
  for (const { channelId } of recording.messages) {
    counted.set(channelId, (counted.get(channelId) ?? 0) + 1);
  }
  const pairs = [
    ["messages", Number(statistics.messageCount), recording.messages.length],
    ["chunks", statistics.chunkCount, recording.chunks.length],
    ["chunk indexes", indexed.chunkIndexes.length, recording.chunks.length],
    ["channels", statistics.channelCount, recording.channels.size],
    ["attachments", statistics.attachmentCount, recording.attachments.length],
    ["attachment indexes", indexed.attachmentIndexes.length, recording.attachments.length],
    ["metadata", statistics.metadataCount, recording.metadata.length],
    ["metadata indexes", indexed.metadataIndexes.length, recording.metadata.length],
    ...[...recording.channels].map(([id, channel]) => [
      `messages on ${channel.topic}`,
      Number(statistics.channelMessageCounts.get(id) ?? 0n),
      counted.get(id) ?? 0,
    ]),
    ["messages by the index", (await collect(indexed.readMessages())).length, recording.messages.length],
    ["attachments by the index", (await collect(indexed.readAttachments())).length, recording.attachments.length],
    ["metadata by the index", (await collect(indexed.readMetadata())).length, recording.metadata.length],
  ];
  const problems = pairs
    .filter(([, told, found]) => told !== found)
    .map(([what, told, found]) => `${what}: ${told} told, ${found} found`);
  hold("summary", problems, `${recording.messages.length} messages in ${recording.channels.size} channels`);
}

function checkChannels(recording, schemas) {
  const problems = [];
  for (const channel of recording.channels.values()) {
    const schema = schemas.get(channel.schemaId);
    if (channel.messageEncoding !== "protobuf" || schema?.encoding !== "protobuf") {
      problems.push(`${channel.topic} is not protobuf`);
      continue;
    }
    for (const rule of layout.topics) {
      if (new RegExp(rule.pattern).test(channel.topic) && schema.name !== rule.schema) {
        problems.push(`${channel.topic} has schema ${schema.name} instead of ${rule.schema}`);
      }
    }
  }
  const topics = [...recording.channels.values()].map(({ topic }) => topic).sort();
  hold("channels", problems, topics.join(" "));
}

/** A descriptor's field as layout.json writes it: `volts=11 repeated float`. */
function fieldText(field) {
  field.resolve();
  const kind = field.resolvedType ? field.resolvedType.fullName.replace(/^\./, "") : field.type;
  return `${field.name}=${field.id} ${field.repeated ? "repeated " : ""}${kind}`;
}

/** Names of the fields of a message, and of the messages in it, that hold a number that is not finite. */
function notFinite(message, type) {
  return type.fieldsArray.flatMap((field) => {
    const value = message[field.name];
    const parts = field.repeated ? value : value == undefined ? [] : [value];
    if (field.resolve().resolvedType?.fieldsArray) {
      return parts.flatMap((part) => notFinite(part, field.resolvedType));
    }
    const isNumber = field.type === "double" || field.type === "float";
    return isNumber && !parts.every(Number.isFinite) ? [field.name] : [];
  });
}

/** Decodes every message; returns those that could be, and whether all have the fields that are looked into. */
function decode(recording, schemas) {
  const types = new Map();
  const decoded = [];
  const problems = [];
  for (const record of recording.messages) {
    const { topic, schemaId } = recording.channels.get(record.channelId);
    const where = `${topic} message ${record.sequence}`;
    try {
      const schema = schemas.get(schemaId);
      if (!types.has(schema.name)) {
        types.set(schema.name, protobufFromBinaryDescriptor(schema.data).lookupType(schema.name));
      }
      const type = types.get(schema.name);
      const message = type.decode(record.data);
      problems.push(...notFinite(message, type).map((name) => `${where}: \`${name}\` is not finite`));
      decoded.push({ topic, schema: schema.name, message });
    } catch (error) {
      // Whatever a foreign reader stumbles over is a finding.
      problems.push(`${where}: ${error.message}`);
    }
  }
  hold("messages decode and are finite", problems, `${decoded.length} messages`);
  const missing = Object.entries(layout.schemas).flatMap(([name, fields]) => {
    if (!types.has(name)) {
      return [];
    }
    const present = new Set(types.get(name).fieldsArray.map(fieldText));
    return fields.filter((field) => !present.has(field)).map((field) => `${name} has no field \`${field}\``);
  });
  hold("fields", missing, [...types.keys()].sort().join(" "));
  return { decoded, fieldsAreThere: missing.length === 0 };
}

function checkTopics(decoded) {
  // The recording of a served session holds what clients saw, and nothing that no sensor saw.
  const served = decoded.some(({ topic }) => topic === "/scpi");
  const simulated =
    !served &&
    decoded.some(
      ({ schema, message }) => schema === "hertzscope.Capture" && message.origin === "simulated",
    );
  const problems = layout.topics
    .filter(({ required }) => required === "always" || (required === "simulated" && simulated))
    .filter(({ pattern }) => !decoded.some(({ topic }) => new RegExp(pattern).test(topic)))
    .map(({ pattern }) => `no message on a topic ${pattern}`);
  const kind = served ? "session" : simulated ? "simulation" : "measurement";
  hold("required topics", problems, `of a ${kind}`);
}

/** What is wrong with one channel's record of one trigger. */
function captureProblems({ topic, message: capture }) {
  const where = `${topic} shot ${capture.shot}`;
  const points = capture.codes.length;
  const problems = [];
  if (capture.source !== topic.split("/").at(-1).toUpperCase()) {
    problems.push(`${where}: source is \`${capture.source}\``);
  }
  if (!layout.origins.includes(capture.origin)) {
    problems.push(`${where}: origin is \`${capture.origin}\``);
  }
  if (!(capture.dt_s > 0)) {
    problems.push(`${where}: dt_s is ${capture.dt_s}`);
  }
  if (!layout.capture_points.includes(points) || capture.volts.length !== points) {
    problems.push(`${where}: ${points} codes and ${capture.volts.length} volts instead of ${layout.capture_points}`);
    return problems;
  }
  const codes = new Int8Array(capture.codes);
  for (let index = 0; index < points; index += 1) {
    const exact = (codes[index] - capture.y_off) * capture.y_mult + capture.y_zero;
    // One unit in the last place of a float32; next to zero, a trifle of a digitiser level.
    const tolerance = Math.max(Math.abs(exact) * 2 ** -23, Math.abs(capture.y_mult) * 2 ** -40);
    if (!(Math.abs(capture.volts[index] - exact) <= tolerance)) {
      problems.push(
        `${where}: volts[${index}] is ${capture.volts[index]}, but level ${codes[index]} means ${exact}`,
      );
      break;
    }
  }
  return problems;
}

/** Index of the first local maximum that reaches half of the greatest value; -1 if nothing rises above zero. */
function firstPeak(values) {
  const enough = values.reduce((greatest, value) => Math.max(greatest, value), 0) / 2;
  return values.findIndex(
    (value, index) =>
      enough > 0 &&
      value >= enough &&
      value >= (values[index - 1] ?? -Infinity) &&
      value >= (values[index + 1] ?? -Infinity),
  );
}

function checkContent(decoded) {
  const captures = decoded.filter(({ schema }) => schema === "hertzscope.Capture");
  hold("levels and volts of captures agree", captures.flatMap(captureProblems), `${captures.length} captures`);
  const series = decoded.filter(({ schema }) => schema === "hertzscope.Series");
  const problems = series.flatMap(({ topic, message }) => {
    const where = `${topic} shot ${message.shot}`;
    return [
      ...(message.values.length > 0 ? [] : [`${where}: no values`]),
      ...(message.dt_s > 0 ? [] : [`${where}: dt_s is ${message.dt_s}`]),
      ...(message.name && message.unit ? [] : [`${where}: name is \`${message.name}\`, unit is \`${message.unit}\``]),
    ];
  });
  hold("series have values, time step, name and unit", problems, `${series.length} series`);
  for (const { topic, message } of series) {
    if (topic.startsWith("/truth/") && message.name.includes(layout.peak_series)) {
      const peak = firstPeak(message.values);
      const text =
        peak < 0
          ? "none above zero"
          : `${message.values[peak].toExponential(6)} ${message.unit} at ` +
            `${(message.t0_s + peak * message.dt_s).toExponential(6)} s`;
      console.log(`note first peak of \`${message.name}\`, shot ${message.shot}: ${text}`);
    }
  }
}

async function main(path) {
  let content;
  try {
    content = new Uint8Array(readFileSync(path));
  } catch (error) {
    console.error(error.message);
    return 2;
  }
  const decompressHandlers = await loadDecompressHandlers();
  let recording;
  let indexed;
  try {
    recording = readInOrder(content, decompressHandlers);
    indexed = await McapIndexedReader.Initialize({ readable: readable(content), decompressHandlers });
  } catch (error) {
    // Whatever a foreign reader stumbles over is a finding.
    hold("file can be read to its end", [error.message]);
    return 1;
  }
  hold("file can be read to its end", []);
  checkCrcs(recording);
  checkAround(recording);
  try {
    await checkSummary(recording, indexed);
  } catch (error) {
    // An index that leads nowhere shows only here.
    hold("summary", [error.message]);
  }
  checkChannels(recording, indexed.schemasById);
  const { decoded, fieldsAreThere } = decode(recording, indexed.schemasById);
  checkTopics(decoded);
  if (fieldsAreThere) {
    checkContent(decoded);
  } else {
    console.log("note captures and series are not looked into, since fields are missing");
  }
  return failed > 0 ? 1 : 0;
}

if (process.argv.length !== 3) {
  console.error("usage: node check.mjs RECORDING.mcap");
  process.exitCode = 2;
} else {
  process.exitCode = await main(process.argv[2]);
}
