#pragma once

#include "recollect/simulation/stock.h"

namespace recollect::simulation {

// What stands along streets. Each shape is built at the builder's place: x along the street,
// y to its left, z up, origin on the ground.

// A lamp post whose arm reaches to the left; `kind` changes its form.
void BuildLampPost(int kind, float height, float reach, const Stock& stock, MeshBuilder& build);
// A concrete pole with cross-arms and a transformer now and then.
void BuildPole(float height, bool transformer, const Stock& stock, MeshBuilder& build);
// A sagging wire between two points of the world (places of the builder do not matter).
void BuildWire(const Vec3& a, const Vec3& b, const Stock& stock, MeshBuilder& build);
// A traffic sign (0 .. 15 of the sheet) that faces against x.
void BuildTrafficSign(int sign, const Stock& stock, MeshBuilder& build);
// A board on two posts with a poster or a name, `width` along y, facing against x.
void BuildBoard(bool poster, int cell, float width, float height, const Stock& stock,
                MeshBuilder& build);
void BuildBench(const Stock& stock, MeshBuilder& build);
void BuildBin(int material, const Stock& stock, MeshBuilder& build);
void BuildBollards(int count, const Stock& stock, MeshBuilder& build);
// A shelter with a bench, open to the left.
void BuildBusStop(Random& random, const Stock& stock, MeshBuilder& build);
// A stall with an awning, about 3 m square.
void BuildKiosk(Random& random, Palette& palette, const Stock& stock, MeshBuilder& build);
// A tank on legs, 10 to 18 m tall.
void BuildWaterTower(Random& random, const Stock& stock, MeshBuilder& build);
// A frame of scaffolding before nets, `width` x `height`, in the plane x = 0 .. 1.2.
void BuildScaffold(float width, float height, const Stock& stock, MeshBuilder& build);

}  // namespace recollect::simulation
