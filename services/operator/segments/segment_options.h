#pragma once

#include <string>
#include <vector>

#include "common/runtime/config.h"
#include "common/runtime/utf8.h"

namespace conav::operators {

/// Section `operator: recording:`: how the operator edits their map after each picture, kept for
/// those who train perception models (docs/nhpm.md, "Segments").
struct SegmentOptions {
  /// Segment file to append to, for example segments.pb.zst; empty = nothing is recorded. Made when
  /// it does not exist, its folder must.
  std::string file;
  /// Who makes the edits: person, or simulated.
  std::string origin = "person";
  /// A pseudonym. It and the session are UTF-8 without slashes and control characters.
  std::string participant;
  /// Pictures' files begin with it. Empty = the time of the start, UTC.
  std::string session;
  /// "world=preset@seed" or "world=map file", as far as known.
  std::vector<std::string> mazes;
  /// Keep the pictures, too, in a folder pictures/ beside the file.
  bool pictures = false;

  void Visit(ConfigReader& reader) {
    reader.Field("file", file);
    reader.Choice("origin", origin, {"person", "simulated"});
    PlainName(reader, "participant", participant);
    PlainName(reader, "session", session);
    reader.Field("mazes", mazes);
    reader.Field("pictures", pictures);
  }

 private:
  static void PlainName(ConfigReader& reader, const char* key, std::string& name) {
    reader.Field(key, name);
    if (!IsPlainName(name)) reader.Refuse(key, kNoPlainName);
  }
};

}  // namespace conav::operators
