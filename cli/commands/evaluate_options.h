// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_EVALUATE_OPTIONS_H_
#define RSSTAB_CLI_COMMANDS_EVALUATE_OPTIONS_H_

#include <cstdint>
#include <optional>
#include <string>

#include "stabilizer/pipeline/option_table.h"

namespace rsstab::cli {

// What is evaluated on; docs/evaluation.md defines each.
enum class EvaluationProtocol {
  kSyntheticVal,  // photographs recorded along known motions
  kPairs,         // rolling-shutter pictures with their global-shutter truth
  kRsReal,        // RS-Real: pictures with their truth and its field
  kClips,         // whole clips, real and simulated, through whole stabilizers
};

// Which of RS-Real's samples.
enum class DatasetSplit { kAll, kTrain, kTest };

// The row whose instant a pair's truth shows, where the names of its files do not tell.
enum class ReferenceRow { kMiddle, kFirst };

// What `rs-stabilize evaluate` is told. Defaults are the member initialisers.
struct EvaluateOptions {
  EvaluationProtocol protocol = EvaluationProtocol::kSyntheticVal;
  std::string photos;   // synthetic-val: folder of photographs
  std::string pairs;    // pairs: folder to look for pairs in
  std::string rs_real;  // rs-real: its folder
  DatasetSplit split = DatasetSplit::kAll;
  ReferenceRow reference_row = ReferenceRow::kMiddle;
  std::string clips;              // clips: folder of clips; naming one means this protocol
  bool twins = false;             // clips: the global-shutter twins of simulated ones as well
  std::string structured;         // list of photographs to be told apart
  std::string structured_source;  // text that the lines of the list must contain to count
  std::int64_t limit = 0;         // photographs or pairs from the first; 0 = all
  std::int64_t linearity_photos = 100;

  // Of synthetic-val; regression only with its model. Unless this is changed, data sets of pictures
  // are given to kDatasetMethods, and clips are steadied by every method of ClipMethodNames().
  std::string methods = "none,regression,sample,mean";
  std::string model;  // empty: the default one
  std::string regression_model;
  std::string reference_model;
  std::string device = "auto";
  int samples = 8;               // of the method "mean"
  int calibration_samples = 16;  // 0 = leave the calibration out
  int steps = 0;                 // 0 = the model's default
  std::optional<double> guidance;
  std::optional<double> eta;
  bool know_focal = false;

  double crf = 12.0;  // of the clips that the methods write
  std::string preset = "ultrafast";

  std::int64_t seed = 1;
  int jobs = 0;            // photographs at a time; 0 = one per core
  std::string csv;         // file for one line per picture and method
  std::string json;        // file for everything in the table
  std::string report;      // file for an HTML page
  bool overwrite = false;  // these may replace files
  std::string state;       // file that a stopped run goes on from; beside csv or json unless given
};

inline constexpr const char* kDatasetMethods =
    "none,gyro,gyro-onestep,diffusion,diffusion@steps=1,samples=1,reference,lines,"
    "homography-mixture,rotation-spline";

[[nodiscard]] const pipeline::OptionTable<EvaluateOptions>& EvaluateOptionTable();

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_EVALUATE_OPTIONS_H_
