// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_CANCELLATION_H_
#define RSSTAB_CLI_CANCELLATION_H_

namespace rsstab::cli {

// From now on the first SIGINT, SIGTERM or SIGHUP only sets a flag, so that the running command can
// stop between two frames and remove what it has half written; a second one ends the program at
// once. SIGPIPE and SIGXFSZ are ignored: a reader that goes away and a file that may not grow are
// then ordinary write errors. Call once, before any thread starts.
void InstallSignalHandlers();

// True once the user asked to stop. Any thread.
[[nodiscard]] bool CancelRequested();

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_CANCELLATION_H_
