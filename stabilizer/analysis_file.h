// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_ANALYSIS_FILE_H_
#define RSSTAB_STABILIZER_ANALYSIS_FILE_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "igf/base/camera.h"
#include "igf/base/motion_field.h"
#include "igf/base/result.h"
#include "stabilizer/global_motion.h"
#include "stabilizer/luma_proxy.h"

namespace rsstab::stabilizer {

// Where the camera looked while a frame's middle row was exposed.
struct FrameOrientation {
  Eigen::Quaterniond camera_from_world = Eigen::Quaterniond::Identity();
  // Frames of one number share a world frame, which is free; a cut or a gap begins another one, and
  // orientations on its two sides are not comparable.
  std::uint32_t world = 0;
};

// What pass 1 found out about one frame, and all that pass 2 needs to render it.
struct FrameAnalysis {
  std::int64_t pts = 0;  // presentation time in the stream's ticks: the key of the record
  LumaFingerprint fingerprint{};
  MotionRung rung = MotionRung::kHold;
  bool path_begins = false;
  // Planned crop ratio with adaptive zoom, in (0, 1].
  double crop_ratio = 1.0;
  // Path update, normalised coordinates (camera_path.h); the zoom in it comes on top of the crop.
  Eigen::Matrix3d rectified_from_output = Eigen::Matrix3d::Identity();
  // Local path update, px of the analysed size; default-made = none.
  MotionField mesh_update;
  // RS field, px of the analysed size; default-made = none.
  MotionField rs_field;
  // Where the source of the rolling-shutter motion knows it. Not needed to render.
  std::optional<FrameOrientation> orientation;
};

// What pass 1 found out about the clip.
struct ClipAnalysis {
  std::string program_version;
  int width = 0;  // analysed (full) size, px
  int height = 0;
  double frames_per_second = 0.0;
  double seconds_per_tick = 0.0;  // of FrameAnalysis::pts; 0: not known
  std::int64_t num_frames = 0;
  // Smallest crop_ratio over all frames: the one that a fixed zoom has to use throughout.
  double smallest_crop_ratio = 1.0;
  bool fixed_zoom = false;           // one crop for all frames instead of each frame's own
  double smallest_kept_ratio = 1.0;  // share of a side that the most enlarged frame shows
  double mean_kept_ratio = 1.0;
  std::string rs_source = "none";  // "gyro", "none", ...
  std::string rs_reason;           // why that source, one sentence
  double readout_s = 0.0;
  double readout_sigma_s = 0.0;  // one standard deviation; 0: given, or not asked for
  // What is known of the shutter: "rolling", "global", "given", "unknown" (the clip does not tell),
  // or empty where nobody asked.
  std::string shutter;
  double focal_px = 0.0;        // 0 where nobody asked
  double focal_sigma_px = 0.0;  // one standard deviation; 0: given
  bool focal_trusted = false;   // known; otherwise assumed
  // The camera's rotation is all that moves the picture, and it is known.
  bool rotation_is_known = false;
  std::optional<double> gyro_offset_s;
  std::optional<Camera> camera;  // of the analysed size
  std::string options;           // as given, "--name value ..." for the record
};

// Share of a side of the picture that the output of a frame of `clip` shows, crop and zoom
// together.
[[nodiscard]] double KeptRatio(const FrameAnalysis& frame, const ClipAnalysis& clip);

// The analysis file: a magic number with the format's version, one record per frame, the clip's
// summary as JSON, a footer; every part with a CRC-32. docs/analysis-file.md tells every byte.
// Fields are stored as 16-bit fractions of their largest displacement (error below 1/65000 of it).

// Writes beside `path` and renames in Finish(); without Finish() nothing is left. In order.
class AnalysisWriter {
 public:
  // Errors: those of StagedFile (kNotFound: no such folder), naming path and cause.
  [[nodiscard]] static Result<std::unique_ptr<AnalysisWriter>> Create(const std::string& path);
  ~AnalysisWriter();
  AnalysisWriter(const AnalysisWriter&) = delete;
  AnalysisWriter& operator=(const AnalysisWriter&) = delete;

  [[nodiscard]] Status Append(const FrameAnalysis& frame);
  // Completes the file; num_frames and the ratios are filled in here. Returns what was
  // written.
  [[nodiscard]] Result<ClipAnalysis> Finish(ClipAnalysis clip);

 private:
  struct Impl;
  explicit AnalysisWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// By what a record is found: when its frame is shown, what it looks like, where the record lies.
struct RecordKey {
  std::int64_t pts = 0;
  std::uint64_t offset = 0;  // byte in the file
  LumaFingerprint fingerprint{};
};

// Reads records in order, or any of them by its key; memory for one record.
class AnalysisReader {
 public:
  // Errors: kNotFound; kCorruptData (not an analysis file, cut off, a checksum differs);
  // kUnsupported (a newer format).
  [[nodiscard]] static Result<std::unique_ptr<AnalysisReader>> Open(const std::string& path);
  ~AnalysisReader();
  AnalysisReader(const AnalysisReader&) = delete;
  AnalysisReader& operator=(const AnalysisReader&) = delete;

  [[nodiscard]] const ClipAnalysis& clip() const;
  // The next record; empty at the end.
  [[nodiscard]] Result<std::optional<FrameAnalysis>> Next();
  // The keys of all records, in the file's order. Follows the records' lengths only: a record is
  // checked when it is read, and so is its key then. Next() begins anew.
  [[nodiscard]] Result<std::vector<RecordKey>> ReadKeys();
  // The record of a key. Next() goes on after it. kCorruptData also when the key is not the
  // record's.
  [[nodiscard]] Result<FrameAnalysis> ReadAt(const std::vector<RecordKey>& keys, std::size_t index);

 private:
  struct Impl;
  explicit AnalysisReader(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_ANALYSIS_FILE_H_
