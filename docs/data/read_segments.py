"""Prints the records of a segment file: python3 read_segments.py FILE

Needs Debian's python3-protobuf and python3-zstandard, and segments_pb2.py from `protoc --python_out=. segments.proto` (in idl/).
"""
import sys

import segments_pb2
import zstandard
from google.protobuf.internal.decoder import _DecodeVarint32

with open(sys.argv[1], "rb") as file:  # a recording has many frames
    data = zstandard.ZstdDecompressor().stream_reader(file, read_across_frames=True).read()
at = 0
while at < len(data):
    size, at = _DecodeVarint32(data, at)
    print(segments_pb2.Record.FromString(data[at:at + size]))
    at += size
