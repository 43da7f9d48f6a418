"""A box as mesh files, for tests."""
import itertools
import struct

# The box, metres: other sides along each axis, and not about the origin.
LOW, HIGH = (-0.02, 0.01, 0.0), (0.04, 0.11, 0.18)
# Corners by bits x, y, z; each side as two triangles, outward.
CORNERS = [tuple((low, high)[index >> axis & 1] for axis, (low, high) in enumerate(zip(LOW, HIGH)))
           for index in range(8)]
SIDES = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
TRIANGLES = [triangle for a, b, c, d in SIDES for triangle in ((a, b, c), (a, c, d))]


def stl():
    facets = [struct.pack("<12fH", 0, 0, 0, *itertools.chain(*(CORNERS[at] for at in triangle)), 0)
              for triangle in TRIANGLES]
    return bytes(80) + struct.pack("<I", len(TRIANGLES)) + b"".join(facets)


def obj():
    lines = [f"v {x} {y} {z}" for x, y, z in CORNERS]
    lines += ["f " + " ".join(str(at + 1) for at in triangle) for triangle in TRIANGLES]
    return "\n".join(lines).encode() + b"\n"


def dae():
    points = " ".join(str(along) for corner in CORNERS for along in corner)
    corners = " ".join(str(at) for triangle in TRIANGLES for at in triangle)
    return f"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="1" name="meter"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="box"><mesh>
<source id="points"><float_array id="floats" count="24">{points}</float_array>
<technique_common><accessor source="#floats" count="8" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
</accessor></technique_common></source>
<vertices id="vertices"><input semantic="POSITION" source="#points"/></vertices>
<triangles count="12"><input semantic="VERTEX" source="#vertices" offset="0"/><p>{corners}</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="scene"><node><instance_geometry url="#box"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#scene"/></scene></COLLADA>""".encode()


def visual(file):
    return f'<visual><geometry><mesh filename="package://meshes_of_test/{file}"/></geometry></visual>'
