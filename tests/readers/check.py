"""Holds a recording against the Python readers `mcap`, `mcap-protobuf-support` and `protobuf`.

    check.py RECORDING.mcap

Prints one line per check. Exit code 0: all hold; 1: at least one does not; 2: there is no such file.
What a recording must hold stands in `layout.json`, which check.mjs reads too. Nothing here knows the program that wrote the file: messages are
decoded by the descriptors that the recording carries.
"""

import io
import json
import math
import re
import struct
import sys
import tomllib
import zlib
from collections import Counter
from pathlib import Path

from google.protobuf.unknown_fields import UnknownFieldSet
from mcap.reader import make_reader
from mcap.records import Attachment, Channel, Chunk, DataEnd, Header, Message, Metadata
from mcap.stream_reader import StreamReader, breakup_chunk
from mcap_protobuf.decoder import DecoderFactory

LAYOUT = json.loads((Path(__file__).parent / "layout.json").read_text())

# The last record of a file: opcode, length, summary start, summary offset start, summary CRC; then the magic bytes.
FOOTER_LENGTH = 1 + 8 + 8 + 8 + 4
MAGIC_LENGTH = 8


class Checks:
    """Prints what was checked and remembers whether all of it held."""

    def __init__(self):
        self.failed = 0

    def hold(self, name, problems, detail=""):
        """One check: it holds if there are no problems. The first few problems are printed."""
        problems = list(problems)
        if problems:
            self.failed += 1
            more = f" (and {len(problems) - 3} more)" if len(problems) > 3 else ""
            print(f"FAIL {name}: {'; '.join(problems[:3])}{more}")
        else:
            print(f"ok   {name}{': ' if detail else ''}{detail}")


class Recording:
    """Everything in the file, in its order; CRCs of chunks and of the data section are verified on the way."""

    def __init__(self, content):
        self.content = content
        self.header = None
        self.channels = {}
        self.schemas = {}
        self.messages = []
        self.attachments = []
        self.metadata = []
        self.chunks = []
        self.data_section_crc = None
        self.footer_summary_start, _, self.summary_crc = struct.unpack(
            "<QQI", content[-MAGIC_LENGTH - FOOTER_LENGTH + 9 : -MAGIC_LENGTH]
        )
        # Chunks are taken apart here, to see whether each has a CRC at all.
        for record in StreamReader(io.BytesIO(content), emit_chunks=True, validate_crcs=True).records:
            if isinstance(record, Chunk):
                self.chunks.append(record)
                for inner in breakup_chunk(record, validate_crc=True):
                    self.take(inner)
            else:
                self.take(record)

    def take(self, record):
        if isinstance(record, Header):
            self.header = record
        elif isinstance(record, Channel):
            self.channels[record.id] = record
        elif isinstance(record, Message):
            self.messages.append(record)
        elif isinstance(record, Attachment):
            self.attachments.append(record)
        elif isinstance(record, Metadata):
            self.metadata.append(record)
        elif isinstance(record, DataEnd):
            self.data_section_crc = record.data_section_crc


def field_text(field):
    """A descriptor's field as layout.json writes it: `volts=11 repeated float`."""
    kinds = {
        field.TYPE_DOUBLE: "double",
        field.TYPE_FLOAT: "float",
        field.TYPE_UINT32: "uint32",
        field.TYPE_STRING: "string",
        field.TYPE_BYTES: "bytes",
        field.TYPE_BOOL: "bool",
        field.TYPE_FIXED32: "fixed32",
    }
    if field.message_type is not None:
        kind = field.message_type.full_name
    elif field.enum_type is not None:
        kind = field.enum_type.full_name
    else:
        kind = kinds.get(field.type, f"type {field.type}")
    return f"{field.name}={field.number} {'repeated ' if field.is_repeated else ''}{kind}"


def not_finite(message):
    """Names of the fields of a message, and of the messages in it, that hold a number that is not finite."""
    for field, value in message.ListFields():
        if field.message_type is not None:
            for part in value if field.is_repeated else [value]:
                yield from not_finite(part)
        elif field.type in (field.TYPE_DOUBLE, field.TYPE_FLOAT):
            if not all(map(math.isfinite, value if field.is_repeated else [value])):
                yield field.name


def capture_problems(topic, capture):
    """What is wrong with one channel's record of one trigger."""
    where = f"{topic} shot {capture.shot}"
    points = len(capture.codes)
    if capture.source != topic.rsplit("/", 1)[-1].upper():
        yield f"{where}: source is `{capture.source}`"
    if capture.origin not in LAYOUT["origins"]:
        yield f"{where}: origin is `{capture.origin}`"
    if not capture.dt_s > 0:
        yield f"{where}: dt_s is {capture.dt_s}"
    if points not in LAYOUT["capture_points"] or len(capture.volts) != points:
        yield f"{where}: {points} codes and {len(capture.volts)} volts instead of {LAYOUT['capture_points']}"
        return
    codes = struct.unpack(f"{points}b", capture.codes)
    for index, (code, volts) in enumerate(zip(codes, capture.volts)):
        exact = (code - capture.y_off) * capture.y_mult + capture.y_zero
        # One unit in the last place of a float32; next to zero, a trifle of a digitiser level.
        tolerance = max(abs(exact) * 2.0**-23, abs(capture.y_mult) * 2.0**-40)
        if not abs(volts - exact) <= tolerance:
            yield f"{where}: volts[{index}] is {volts!r}, but level {code} means {exact!r}"
            return


def first_peak(values):
    """Index of the first local maximum that reaches half of the greatest value; None if nothing rises above zero."""
    enough = max(values, default=0.0) / 2
    if enough <= 0:
        return None
    for index, value in enumerate(values):
        before = values[index - 1] if index > 0 else -math.inf
        after = values[index + 1] if index + 1 < len(values) else -math.inf
        if value >= enough and value >= before and value >= after:
            return index
    return None


def check_crcs(checks, recording, summary):
    """Chunks and data section were verified while reading; the rest is computed here."""
    content = recording.content
    problems = [f"chunk {i} has no CRC" for i, chunk in enumerate(recording.chunks) if chunk.uncompressed_crc == 0]
    if not recording.data_section_crc:
        problems.append("the data section has no CRC")
    # From the summary's start to the CRC in the footer, which is the last thing before the magic bytes.
    found = zlib.crc32(content[recording.footer_summary_start : -MAGIC_LENGTH - 4])
    if recording.summary_crc != found:
        problems.append(f"summary CRC is {recording.summary_crc:08x}, computed {found:08x}")
    for index in summary.attachment_indexes if summary else []:
        # Opcode and length are not covered.
        record = content[index.offset + 9 : index.offset + index.length]
        stored = struct.unpack("<I", record[-4:])[0]
        if stored != zlib.crc32(record[:-4]):
            problems.append(f"attachment `{index.name}` has a wrong CRC")
    checks.hold("CRCs", problems, f"{len(recording.chunks)} chunks, data section, summary, attachments")


def check_summary(checks, recording, summary):
    statistics = summary.statistics
    if statistics is None:
        checks.hold("summary", ["no statistics"])
        return
    counted = Counter(message.channel_id for message in recording.messages)
    pairs = {
        "messages": (statistics.message_count, len(recording.messages)),
        "chunks": (statistics.chunk_count, len(recording.chunks)),
        "chunk indexes": (len(summary.chunk_indexes), len(recording.chunks)),
        "channels": (statistics.channel_count, len(recording.channels)),
        "attachments": (statistics.attachment_count, len(recording.attachments)),
        "attachment indexes": (len(summary.attachment_indexes), len(recording.attachments)),
        "metadata": (statistics.metadata_count, len(recording.metadata)),
        "metadata indexes": (len(summary.metadata_indexes), len(recording.metadata)),
        "messages by channel": ({k: v for k, v in statistics.channel_message_counts.items() if v}, dict(counted)),
    }
    problems = [f"{what}: {told} told, {found} found" for what, (told, found) in pairs.items() if told != found]
    indexed = sum(1 for _ in make_reader(io.BytesIO(recording.content), validate_crcs=True).iter_messages())
    if indexed != len(recording.messages):
        problems.append(f"{indexed} messages by the index, {len(recording.messages)} in the file")
    checks.hold("summary", problems, f"{len(recording.messages)} messages in {len(recording.channels)} channels")


def check_channels(checks, recording, summary):
    problems = []
    for channel in recording.channels.values():
        schema = summary.schemas.get(channel.schema_id)
        if channel.message_encoding != "protobuf" or schema is None or schema.encoding != "protobuf":
            problems.append(f"{channel.topic} is not protobuf")
            continue
        for rule in LAYOUT["topics"]:
            if re.search(rule["pattern"], channel.topic) and schema.name != rule["schema"]:
                problems.append(f"{channel.topic} has schema {schema.name} instead of {rule['schema']}")
    checks.hold("channels", problems, " ".join(sorted(channel.topic for channel in recording.channels.values())))


def decode(checks, recording, summary):
    """Decodes every message; returns those that could be as (topic, schema name, message),
    and whether all of them have the fields that are looked into."""
    factory = DecoderFactory()
    decoded, problems, layouts = [], [], {}
    for record in recording.messages:
        channel = recording.channels[record.channel_id]
        schema = summary.schemas.get(channel.schema_id)
        try:
            decoder = factory.decoder_for(channel.message_encoding, schema)
            message = decoder(record.data)
        except Exception as error:  # Whatever a foreign reader stumbles over is a finding.
            problems.append(f"{channel.topic} message {record.sequence}: {type(error).__name__} {error}")
            continue
        if len(UnknownFieldSet(message)):
            problems.append(f"{channel.topic} message {record.sequence}: a field that the schema does not know")
        problems += [f"{channel.topic} message {record.sequence}: `{name}` is not finite" for name in not_finite(message)]
        layouts[schema.name] = {field_text(field) for field in message.DESCRIPTOR.fields}
        decoded.append((channel.topic, schema.name, message))
    checks.hold("messages decode and are finite", problems, f"{len(decoded)} messages")
    problems = [
        f"{name} has no field `{field}`"
        for name, fields in LAYOUT["schemas"].items()
        if name in layouts
        for field in fields
        if field not in layouts[name]
    ]
    checks.hold("fields", problems, " ".join(sorted(layouts)))
    return decoded, not problems


def check_topics(checks, decoded):
    captures = [message for _, name, message in decoded if name == "hertzscope.Capture"]
    # The recording of a served session holds what clients saw, and nothing that no sensor saw.
    served = any(topic == "/scpi" for topic, _, _ in decoded)
    simulated = not served and any(message.origin == "simulated" for message in captures)
    problems = [
        f"no message on a topic {rule['pattern']}"
        for rule in LAYOUT["topics"]
        if (rule["required"] == "always" or (rule["required"] == "simulated" and simulated))
        and not any(re.search(rule["pattern"], topic) for topic, _, _ in decoded)
    ]
    checks.hold("required topics", problems, "of a simulation" if simulated else "of a session" if served else "of a measurement")


def check_content(checks, decoded):
    captures = [(topic, message) for topic, name, message in decoded if name == "hertzscope.Capture"]
    problems = [problem for topic, capture in captures for problem in capture_problems(topic, capture)]
    checks.hold("levels and volts of captures agree", problems, f"{len(captures)} captures")
    series = [(topic, message) for topic, name, message in decoded if name == "hertzscope.Series"]
    problems = []
    for topic, message in series:
        where = f"{topic} shot {message.shot}"
        if not message.values:
            problems.append(f"{where}: no values")
        if not message.dt_s > 0:
            problems.append(f"{where}: dt_s is {message.dt_s}")
        if not message.name or not message.unit:
            problems.append(f"{where}: name is `{message.name}`, unit is `{message.unit}`")
    checks.hold("series have values, time step, name and unit", problems, f"{len(series)} series")
    for topic, message in series:
        if topic.startswith("/truth/") and LAYOUT["peak_series"] in message.name:
            peak = first_peak(message.values)
            if peak is None:
                text = "none above zero"
            else:
                text = f"{message.values[peak]:.6e} {message.unit} at {message.t0_s + peak * message.dt_s:.6e} s"
            print(f"note first peak of `{message.name}`, shot {message.shot}: {text}")


def check_around(checks, recording):
    """What stands around the messages: profile, library, metadata, the scene."""
    header = recording.header
    problems = [f"no {name}" for name in ("profile", "library") if not getattr(header, name)]
    checks.hold("header", problems, f"profile `{header.profile}`, library `{header.library}`")
    times = [message.log_time for message in recording.messages]
    problems = [f"message {i + 1} is earlier than the one before" for i, (a, b) in enumerate(zip(times, times[1:])) if b < a]
    checks.hold("log times never decrease", problems)
    names = [record.name for record in recording.metadata]
    problems = [
        f"no metadata {pattern}"
        for pattern in LAYOUT["required_metadata"]
        if not any(re.search(pattern, name) for name in names)
    ]
    for record in recording.metadata:
        if record.name == LAYOUT["recording_metadata"]:
            problems += [f"{record.name} has no `{key}`" for key in LAYOUT["recording_keys"] if key not in record.metadata]
    checks.hold("metadata", problems, " ".join(names))
    scenes = [a for a in recording.attachments if a.media_type == LAYOUT["scene_media_type"]]
    problems = [] if scenes else [f"no attachment of type {LAYOUT['scene_media_type']}"]
    for scene in scenes:
        try:
            if not tomllib.loads(scene.data.decode("utf-8")):
                problems.append(f"`{scene.name}` is empty")
        except ValueError as error:
            problems.append(f"`{scene.name}`: {error}")
    checks.hold("scene", problems, " ".join(scene.name for scene in scenes))


def main(path):
    try:
        content = Path(path).read_bytes()
    except OSError as error:
        print(error, file=sys.stderr)
        return 2
    checks = Checks()
    try:
        recording = Recording(content)
        summary = make_reader(io.BytesIO(recording.content)).get_summary()
    except Exception as error:  # Whatever a foreign reader stumbles over is a finding.
        checks.hold("file can be read to its end", [f"{type(error).__name__} {error}"])
        return 1
    checks.hold("file can be read to its end", [])
    check_crcs(checks, recording, summary)
    check_around(checks, recording)
    if summary is None:
        checks.hold("summary", ["there is none"])
        return 1
    try:
        check_summary(checks, recording, summary)
    except Exception as error:  # An index that leads nowhere shows only here.
        checks.hold("summary", [f"{type(error).__name__} {error}"])
    check_channels(checks, recording, summary)
    decoded, fields_are_there = decode(checks, recording, summary)
    check_topics(checks, decoded)
    if fields_are_there:
        check_content(checks, decoded)
    else:
        print("note captures and series are not looked into, since fields are missing")
    return 1 if checks.failed else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        print("usage: check.py RECORDING.mcap", file=sys.stderr)
        sys.exit(2)
    sys.exit(main(sys.argv[1]))
