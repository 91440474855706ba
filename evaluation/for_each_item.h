// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_FOR_EACH_ITEM_H_
#define RSSTAB_EVALUATION_FOR_EACH_ITEM_H_

#include <cstdint>
#include <functional>

#include "evaluation/motion_method.h"
#include "igf/base/result.h"

namespace rsstab::evaluation {

// Called after each item, one call at a time; false stops.
using EvaluationProgress = std::function<bool(std::int64_t done, std::int64_t items)>;

// Calls work(index, methods) for every index of [0, count), on `jobs` >= 1 threads, each with
// methods of its own. Which thread gets which item is left to chance, so `work` writes to a place
// of its item only. It may throw: what it throws is handed to `failed`, as is its error; other
// items go on.
// Errors: those of the factory; kCancelled when `progress` asked to stop.
[[nodiscard]] Status ForEachItem(int count, int jobs, const MethodFactory& factory,
                                 const std::function<Status(int index, MethodSet& methods)>& work,
                                 const std::function<void(int index, const Error& error)>& failed,
                                 const EvaluationProgress& progress = {});

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_FOR_EACH_ITEM_H_
