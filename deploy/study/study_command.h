#pragma once

#include "common/runtime/stop_token.h"
#include "study/provenance.h"
#include "study/study_options.h"

namespace conav::study {

/// The whole study: goes on where an earlier run of the same study stopped, prints table 3, writes
/// the files of StudyFolder and --json. Exit code: 0 done; 1 an episode failed, it was interrupted,
/// a file could not be written, or a bar was missed with --check; 2 wrong use.
int RunStudy(const StudyOptions& options, const Provenance& provenance, const StopToken& stop);

}  // namespace conav::study
