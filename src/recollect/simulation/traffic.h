#pragma once

#include <vector>

#include "recollect/simulation/campus.h"

namespace recollect::simulation {

// What else is on the road during one drive: cars ahead, some of them close, cars that come the
// other way, people on the pavements. Where each is follows from the time alone.
class Traffic {
 public:
  // The arguments must outlive it.
  Traffic(const Campus& campus, const Vehicles& vehicles, const Day& day, const Drive& drive);

  // All movers within sight of the car at a time of the drive; none meets the car.
  std::vector<Instance> At(double time) const;

 private:
  struct Ahead {  // keeps a distance in front of us over a stretch of the drive
    double from, to, gap, sway;
    int model;
    Color paint;
  };
  struct Oncoming {
    double meets_at, meets_when, speed;  // distance along the drive, time, metres a second
    int model;
    Color paint;
  };
  struct Walker {
    std::size_t street;
    float s, side, pace, phase;
    int model;
  };

  double Distance(double time) const;
  double TimeAt(double distance) const;
  // On the ground, `distance` along the drive and `side` metres to its left.
  Instance OnDrive(double distance, double side, bool backwards, int model,
                   const Color& paint) const;

  const Campus& campus_;
  const Vehicles& vehicles_;
  const Drive& drive_;
  std::vector<double> distances_;  // driven until each pose
  std::vector<Ahead> ahead_;
  std::vector<Oncoming> oncoming_;
  std::vector<Walker> walkers_;
};

}  // namespace recollect::simulation
