#!/usr/bin/env python3
"""Writes a furnished house of two rooms as glTF, for training: another one for each seed.

  make_room.py SEED FILE.gltf

Lamps of different colours, some of which move, a box that does, and for every second seed a hole in
the roof with sun and sky.
"""
import base64
import json
import math
import random
import struct
import sys


class Room:
    """Collects boxes, lights and animations. Every box is the cube below, moved and scaled."""

    def __init__(self):
        self.gltf = {
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": []}],
            "nodes": [], "meshes": [], "materials": [], "accessors": [], "bufferViews": [],
            "animations": [{"channels": [], "samplers": []}],
            "extensionsUsed": ["KHR_lights_punctual"],
            "extensions": {"KHR_lights_punctual": {"lights": []}},
        }
        self.bytes = b""
        positions, normals, indices = [], [], []
        for axis in range(3):
            for sign in (-1, 1):
                normal = [0, 0, 0]
                normal[axis] = sign
                first = len(positions)
                for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                    corner = [0, 0, 0]
                    corner[axis] = sign
                    corner[(axis + 1) % 3] = a
                    corner[(axis + 2) % 3] = b
                    positions.append([c / 2 for c in corner])
                    normals.append(normal)
                order = (0, 1, 2, 0, 2, 3) if sign > 0 else (0, 2, 1, 0, 3, 2)
                indices += [first + i for i in order]
        self.cube = {"attributes": {"POSITION": self.floats(positions, "VEC3"),
                                    "NORMAL": self.floats(normals, "VEC3")},
                     "indices": self.accessor(struct.pack(f"<{len(indices)}H", *indices),
                                              len(indices), 5123, "SCALAR", {})}

    def accessor(self, data, count, component, kind, more):
        self.gltf["bufferViews"].append(
            {"buffer": 0, "byteOffset": len(self.bytes), "byteLength": len(data)})
        self.bytes += data
        self.gltf["accessors"].append({"bufferView": len(self.gltf["bufferViews"]) - 1,
                                       "componentType": component, "count": count, "type": kind,
                                       **more})
        return len(self.gltf["accessors"]) - 1

    def floats(self, rows, kind):
        flat = [v for row in rows for v in row]
        least = [min(column) for column in zip(*rows)]
        most = [max(column) for column in zip(*rows)]
        return self.accessor(struct.pack(f"<{len(flat)}f", *flat), len(rows), 5126, kind,
                             {"min": least, "max": most})

    def material(self, colour, emission=(0, 0, 0)):
        self.gltf["materials"].append(
            {"pbrMetallicRoughness": {"baseColorFactor": [*colour, 1], "metallicFactor": 0},
             "emissiveFactor": list(emission)})
        self.gltf["meshes"].append(
            {"primitives": [{**self.cube, "material": len(self.gltf["materials"]) - 1}]})
        return len(self.gltf["meshes"]) - 1

    def node(self, node):
        self.gltf["nodes"].append(node)
        self.gltf["scenes"][0]["nodes"].append(len(self.gltf["nodes"]) - 1)
        return len(self.gltf["nodes"]) - 1

    def box(self, mesh, low, high):
        return self.node({"mesh": mesh,
                          "translation": [(a + b) / 2 for a, b in zip(low, high)],
                          "scale": [b - a for a, b in zip(low, high)]})

    def light(self, light, node):
        lights = self.gltf["extensions"]["KHR_lights_punctual"]["lights"]
        lights.append(light)
        node["extensions"] = {"KHR_lights_punctual": {"light": len(lights) - 1}}
        return self.node(node)

    def move(self, node, times, places):
        animation = self.gltf["animations"][0]
        animation["samplers"].append({"input": self.floats([[t] for t in times], "SCALAR"),
                                      "output": self.floats(places, "VEC3")})
        animation["channels"].append({"sampler": len(animation["samplers"]) - 1,
                                      "target": {"node": node, "path": "translation"}})

    def text(self):
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.bytes).decode()
        self.gltf["buffers"] = [{"byteLength": len(self.bytes), "uri": uri}]
        return json.dumps(self.gltf)


def make(seed):
    dice = random.Random(seed)
    room = Room()
    width, height, depth = dice.uniform(10, 16), dice.uniform(3, 6), dice.uniform(9, 14)
    thick, door = 0.3, dice.uniform(0.3, 0.7) * depth
    wall = dice.uniform(0.35, 0.65) * width

    def colour():
        return [dice.uniform(0.15, 0.85) for _ in range(3)]

    walls, floor, roof = (room.material(colour()) for _ in range(3))
    room.box(floor, (-thick, -thick, -thick), (width + thick, 0, depth + thick))
    for low, high in (((-thick, 0, -thick), (0, height, depth + thick)),
                      ((width, 0, -thick), (width + thick, height, depth + thick)),
                      ((0, 0, -thick), (width, height, 0)),
                      ((0, 0, depth), (width, height, depth + thick)),
                      ((wall, 0, 0), (wall + thick, height, door)),
                      ((wall, 0, door + 1.4), (wall + thick, height, depth)),
                      ((wall, 2.2, door), (wall + thick, height, door + 1.4))):
        room.box(walls, low, high)
    hole = dice.uniform(1.5, 4) if seed % 2 else 0
    room.box(roof, (-thick, height, -thick), (wall, height + thick, depth + thick))
    room.box(roof, (wall + hole, height, -thick), (width + thick, height + thick, depth + thick))
    if hole:
        turn = dice.uniform(-0.5, 0.5)
        room.light({"type": "directional", "intensity": 3, "color": [1, 0.95, 0.85]},
                   {"rotation": [math.sin(-math.pi / 4 + turn / 2), 0, 0,
                                 math.cos(-math.pi / 4 + turn / 2)]})
    for _ in range(dice.randint(12, 24)):
        size = [dice.uniform(0.3, 2), dice.uniform(0.3, height * 0.8), dice.uniform(0.3, 2)]
        place = [dice.uniform(0.2, width - size[0]), 0, dice.uniform(0.2, depth - size[2])]
        if dice.random() < 0.2:
            place[1] = dice.uniform(0.5, 2)
            size[1] = 0.1
        room.box(room.material(colour()), place, [a + b for a, b in zip(place, size)])
    panel = room.material((0.5, 0.5, 0.5), [dice.uniform(0.3, 1) for _ in range(3)])
    room.box(panel, (wall * 0.3, height - 0.15, depth * 0.4),
             (wall * 0.6, height - 0.05, depth * 0.6))
    room.gltf["scenes"][0]["extras"] = {"gicodec": {"volume": {
        "grid": [round(side / 1.1) for side in (width, height, depth)],
        "first": [0.35, 0.3, 0.35], "last": [width - 0.35, height - 0.3, depth - 0.35]}}}
    times = [i / 2 for i in range(9)]

    def path(low, high):
        places = [[dice.uniform(0.5, width - 0.5), dice.uniform(low, high),
                   dice.uniform(0.5, depth - 0.5)] for _ in range(8)]
        return places + [places[0]]

    for i in range(dice.randint(2, 5)):
        way = path(1.5, height - 0.4)
        lamp = room.light({"type": "point", "color": colour(), "intensity": dice.uniform(2, 20)},
                          {"translation": way[0]})
        if i % 2:
            room.move(lamp, times, way)
    way = path(0.6, 1.5)
    room.move(room.box(room.material(colour()), [c - 0.5 for c in way[0]],
                       [c + 0.5 for c in way[0]]), times, way)
    return room.text()


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    with open(sys.argv[2], "w", encoding="utf-8") as file:
        file.write(make(int(sys.argv[1])))


if __name__ == "__main__":
    main()
