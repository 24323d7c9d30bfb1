#pragma once

#include "operator/bag/mcap_contents.h"

namespace conav::bag {

/// Takes up a schema or channel record; of two with one id the first counts. False when it is
/// damaged.
bool AddDescription(const Record& record, McapContents& contents);

/// ReadContents without a summary: reads every record of the data section, and unpacks every chunk.
/// A record that the end of the file cuts off and what is no record (zeros, which a loss of power can
/// leave) end the data; chunks that are damaged are left out, and so are messages whose topics were
/// described in these. `cut_off` tells all that, and is never empty: the summary is missing at least.
[[nodiscard]] Result<McapContents> ScanContents(const InputFile& file);

}  // namespace conav::bag
