#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <vector>

#include "recollect/core/progress.h"
#include "recollect/dataset/lap.h"
#include "recollect/map/description.h"
#include "recollect/map/store.h"
#include "recollect/wnn/memory.h"

namespace recollect {

class ThreadPool;

// A mapped image: where its camera stood, and where it came from.
struct KeyFrame {
  SE3 world_from_camera;
  double time = 0;          // seconds, the lap's own
  std::uint32_t lap = 0;    // index into MapDescription::laps
  std::uint32_t frame = 0;  // index into that lap's frames
};

// A map opened for reading: key frames with image and pose, and what the weightless network has
// learnt of them, all read in place from one memory-mapped file. Opening costs a few milliseconds
// whatever the size. Key frames are numbered from 0 in the order they were added; the number is
// also the entry in memory().
class Map {
 public:
  // Throws Error naming the file when it is missing, foreign, cut short or inconsistent.
  static Map Open(const std::filesystem::path& file);

  const MapDescription& description() const { return description_; }
  int size() const { return memory_.entries(); }
  std::size_t FileBytes() const { return store_.FileBytes(); }

  // key in [0, size()); Error otherwise, or where the record is damaged.
  KeyFrame At(int key) const;
  // The mapped image, 8-bit B, G, R, of the size of description().camera.
  cv::Mat Image(int key) const;
  // What was put beside the key frame to find poses by geometry, as it was given; nothing where the
  // map has none. Valid as long as the map.
  std::optional<Bytes> Geometry(int key) const;
  bool HasGeometry() const { return store_.Count(Table::kGeometry) > 0; }
  // Patterns of all key frames (labels are key frame numbers). Valid as long as the map.
  const wnn::Memory& memory() const { return memory_; }

 private:
  Map(StoreReader store, MapDescription description);

  StoreReader store_;
  MapDescription description_;
  wnn::Memory memory_;
};

// Makes what Map::Geometry gives back, of a lap's frame; empty for none. Called from several
// threads.
using GeometrySource = std::function<std::vector<std::byte>(const Lap& lap, std::size_t frame)>;

struct MapOptions {
  double spacing_m = 5;  // between key frames of a lap; 10 degrees of turn also make one
  // The weightless network; fixed for the life of the map.
  wnn::NetworkOptions network = wnn::RecollectNetwork();
  GeometrySource geometry;  // none: a map without geometry
};

// Makes a map of key frames sampled from `laps`, which must have images of one size and poses in
// one world. The file appears under its name when it is whole. Throws Error on bad input, before
// anything is written, and when writing fails.
void CreateMap(const std::filesystem::path& file, std::span<const Lap> laps,
               const MapOptions& options, ThreadPool& pool, const ProgressSink& progress = {});

// Appends the key frames of further laps, sampled as the map's others, in one transaction: all of
// them or, on any Error, none. What is there is neither moved nor rewritten, but for the last,
// partly filled block of patterns. geometry: used where the map has some, which then needs it.
void AddToMap(const std::filesystem::path& file, std::span<const Lap> laps, ThreadPool& pool,
              const ProgressSink& progress = {}, const GeometrySource& geometry = {});

// How much larger than its model says the error of a pose found by geometry is; see
// MapDescription::geometry_inflation.
void SetGeometryInflation(const std::filesystem::path& file, double inflation);

// What votes are worth in this map; see MapDescription::recognition and CalibrateRecognition.
void SetRecognition(const std::filesystem::path& file, const wnn::Calibration& calibration);

}  // namespace recollect
