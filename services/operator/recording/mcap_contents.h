#pragma once

#include <map>
#include <string>
#include <vector>

#include "operator/recording/mcap_records.h"
#include "operator/recording/recording_files.h"

namespace conav::bag {

/// What is in an MCAP file, and where.
struct McapContents {
  std::map<std::uint16_t, Schema> schemas;
  std::map<std::uint16_t, Channel> channels;  // each names one of the schemas, or 0 for none
  std::vector<ChunkIndex> chunks;             // in the order of the file
  Statistics statistics;
  std::vector<Metadata> metadata;
  /// Empty for a file that was finished; otherwise what is missing, in words.
  std::string cut_off;
};

/// From the summary at the end; by reading all chunks where there is no summary, which says so in
/// `cut_off` if the file was not finished.
/// Errors, each with the path: kIo; kMalformed: no MCAP file, a record or a chunk that is damaged
/// (but at the very end of a file that was not finished: that is cut off), a channel or schema that
/// is not there; kRefused: messages outside of chunks, compression that is not read here.
[[nodiscard]] Result<McapContents> ReadContents(const InputFile& file);

/// The records of a chunk. Errors as above, with the chunk's place in the file.
[[nodiscard]] Result<Bytes> ReadChunkAt(const InputFile& file, std::uint64_t offset,
                                        std::uint64_t length);

/// "FILE: at byte N: WHAT".
tl::unexpected<Error> DamagedAt(const InputFile& file, std::uint64_t offset,
                                const std::string& what, ErrorCode code = ErrorCode::kMalformed);

}  // namespace conav::bag
