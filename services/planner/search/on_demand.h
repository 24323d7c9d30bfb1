#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

namespace conav::planner {

/// Values by number, as an array whose parts exist once they are needed: what a decision keeps of
/// each vertex costs no more than the vertices that it looks at, however many there are. References
/// stay valid. Threads: one at a time.
template <class T>
class OnDemand {
 public:
  explicit OnDemand(std::size_t size = 0) : parts_((size + kPart - 1) / kPart) {}

  /// T{} at first.
  T& operator[](std::size_t number) {
    auto& part = parts_[number / kPart];
    if (!part) [[unlikely]] {
      part = std::make_unique<Part>();
    }
    return (*part)[number % kPart];
  }
  const T& operator[](std::size_t number) const {
    static const T none{};
    const auto& part = parts_[number / kPart];
    return part ? (*part)[number % kPart] : none;
  }

 private:
  static constexpr std::size_t kPart = 32;  // numbers that follow each other are needed together
  using Part = std::array<T, kPart>;

  std::vector<std::unique_ptr<Part>> parts_;
};

}  // namespace conav::planner
