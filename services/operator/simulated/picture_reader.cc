#include "operator/simulated/picture_reader.h"

namespace conav::operators {

PictureReader::PictureReader(const PictureReaderParameters& parameters, std::uint64_t seed)
    : parameters_(parameters), random_(seed) {}

std::vector<CellEdit> PictureReader::Read(const BeliefGrid& belief, const Picture& picture,
                                          const std::set<Cell>& certain) {
  return PictureReading(parameters_, belief, picture, certain).Draw(random_);
}

}  // namespace conav::operators
