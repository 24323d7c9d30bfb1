#pragma once

#include <filesystem>

#include "common/runtime/clock.h"
#include "common/runtime/stop_token.h"
#include "study/supervision_record.h"

namespace conav::study {

/// Runs one trial: all services as processes of their own over DDS, in a domain where nobody else
/// is; listens to robots and attention queue until every world's time is up.
/// Blocks. Whatever goes wrong is in the record; a trial that `stop` ends says so, too. Its run
/// folder stays under `options.out`/runs/<trial>. Threads: one per call; several at a time are fine.
SupervisionRecord PlayTrial(const SupervisionTrial& trial, const SupervisionOptions& options,
                            const std::filesystem::path& program_folder, const Clock& clock,
                            const StopToken& stop);

}  // namespace conav::study
