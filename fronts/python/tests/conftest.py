"""A level that several tests bake."""

import struct

import numpy as np
import pytest


def floors():
    """The bytes of a file: three floors, one above the other, each a node."""
    points = np.array([[0, 0, 0], [9, 0, 0], [9, 0, 9], [0, 0, 9]], "<f4")
    faces = np.array([0, 2, 1, 0, 3, 2], "<u2")
    data = points.tobytes() + faces.tobytes()
    nodes = ",".join('{"mesh":0,"translation":[0,%d,0]}' % y for y in (0, 3, 6))
    text = (
        '{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1,2]}],"nodes":[%s],'
        '"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],'
        '"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[9,0,9]},'
        '{"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}],'
        '"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],'
        '"buffers":[{"byteLength":60}]}' % nodes
    ).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


@pytest.fixture(scope="session")
def level(tmp_path_factory):
    path = tmp_path_factory.mktemp("level") / "level.glb"
    path.write_bytes(floors())
    return path
