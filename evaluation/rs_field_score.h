// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_RS_FIELD_SCORE_H_
#define RSSTAB_EVALUATION_RS_FIELD_SCORE_H_

#include <cstdint>
#include <optional>
#include <string>

#include "igf/base/result.h"
#include "igf/simulation_truth.h"

namespace rsstab::evaluation {

// The rolling-shutter fields of a whole clip. px at 640 px width.
struct RsFieldScore {
  std::int64_t frames = 0;
  // Root mean square displacement over all vertices and frames; a frame without a field counts as
  // one of zeros.
  double applied_px = 0.0;
  // Mean over the frames of the end-point error against the exact field, over the pixels whose
  // source lies inside the recorded frame; only where the truth is known.
  std::optional<double> epe_px;
  std::optional<double> uncorrected_epe_px;  // the same of no field at all
};

// Reads the fields that pass 1 stored in an analysis file. `truth` may be null; its n-th frame is
// the n-th of the file, and its camera, scaled to the analysed size, its readout time and
// orientation give the exact field.
// Errors: those of stabilizer::AnalysisReader; kInvalidArgument when file and truth differ in the
// number of frames.
[[nodiscard]] Result<RsFieldScore> ScoreRsFields(const std::string& analysis_file,
                                                 const igf::SimulationTruth* truth);

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_RS_FIELD_SCORE_H_
