// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_MEDIA_AV_LOG_H_
#define RSSTAB_CLI_MEDIA_AV_LOG_H_

#include "igf/base/log.h"

namespace rsstab::media {

// Takes libav's messages off stderr for the whole process (its log callback is global, so this is
// done once and never undone). From then on a message of a context whose `opaque` member points to
// a Logger goes to that logger at debug level, every other one is dropped. Our own errors and
// warnings say what matters to the user; libav's lines are for diagnosis. Any thread.
//
// Consequence: within this program `opaque` of an AVFormatContext or AVCodecContext is a Logger* or
// null, nothing else.
void RouteAvLog();

}  // namespace rsstab::media

#endif  // RSSTAB_CLI_MEDIA_AV_LOG_H_
