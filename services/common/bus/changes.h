#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"

// A latched topic with large messages that change little, as maps are, has a second one that carries
// changes over links (conav_msgs/MessageChange). Other programs, such as ROS 2 tools, read the first.

namespace conav::bus {

/// Threads: one caller.
class ChangeEncoder {
 public:
  /// Of kChangesQos's history, so that a late joiner gets a whole one.
  static constexpr int kMostInARow = kChangesQos.depth - 1;

  /// `payload`: the message's CDR with encapsulation. The first is whole, and one in each kMostInARow + 1.
  conav_msgs::msg::MessageChange Encode(std::span<const std::uint8_t> payload);

 private:
  std::vector<std::uint8_t> last_;
  int since_whole_ = 0;
};

/// Threads: one caller.
class ChangeDecoder {
 public:
  /// The message's CDR, valid until the next call; none if the change belongs to another base, as those do
  /// that a late joiner gets before its first whole one. Errors: kMalformed, and the base stays.
  [[nodiscard]] Result<std::optional<std::span<const std::uint8_t>>> Decode(
      const conav_msgs::msg::MessageChange& change);

 private:
  std::vector<std::uint8_t> last_;
};

/// Sends each message whole to the subscribers of `topic`, and over links its changes.
template <class T>
class ChangesPublisher {
 public:
  ChangesPublisher(Participant& participant, const Topic<T>& topic,
                   const Topic<conav_msgs::msg::MessageChange>& changes, std::string_view entity)
      : whole_(participant, topic, entity) {
    if (participant.over_link()) changes_.emplace(participant, changes, entity);
  }

  void Send(const T& message) {
    bus::Send(whole_, message);
    if (!changes_) return;
    const TypeSupport& type = TypeSupportOf<T>();
    payload_.resize(PayloadSize(type, &message));
    payload_.resize(ToPayload(type, &message, payload_));
    bus::Send(*changes_, encoder_.Encode(payload_));
  }

 private:
  Publisher<T> whole_;
  std::optional<Publisher<conav_msgs::msg::MessageChange>> changes_;
  ChangeEncoder encoder_;
  std::vector<std::uint8_t> payload_;
};

/// The messages of a topic that has changes: over a link those where somebody publishes them.
/// Threads: one caller.
template <class T>
class ChangesSubscriber {
 public:
  ChangesSubscriber(Participant& participant, const Topic<T>& topic,
                    const Topic<conav_msgs::msg::MessageChange>& changes, const std::string& entity)
      : participant_(participant), topic_(topic), entity_(entity) {
    if (participant.over_link()) changes_.emplace(participant, changes, entity);
    ChooseTopic();
  }

  /// As Subscriber::TakeValid, but for those that are older than what came of the other topic.
  template <class Convert>
  auto TakeValid(Convert&& convert) {
    using Domain = typename std::invoke_result_t<Convert, T>::value_type;
    std::vector<Domain> valid;
    const auto add = [&](const void* source, SourceTime time, Domain&& value) {
      if (source != newest_ && time < newest_time_) return;
      newest_ = source;
      newest_time_ = time;
      valid.push_back(std::move(value));
    };
    if (whole_) {
      for (auto& one : whole_->TakeValidStamped(convert))
        add(&whole_, one.source, std::move(one.value));
    }
    if (changes_) {
      const auto apply = [&](const conav_msgs::msg::MessageChange& change) {
        return Apply<Domain>(change, convert);
      };
      for (auto& one : changes_->TakeValidStamped(apply)) {
        if (one.value) add(&changes_, one.source, *std::move(one.value));
      }
    }
    ChooseTopic();
    return valid;
  }

  int matched_publishers() const {
    return whole_ ? whole_->matched_publishers() : changes_->matched_publishers();
  }

 private:
  void ChooseTopic() {
    const bool needs_whole = !changes_ || changes_->matched_publishers() == 0;
    if (needs_whole == whole_.has_value()) return;
    whole_.reset();
    if (needs_whole) whole_.emplace(participant_, topic_, entity_);
  }

  template <class Domain, class Convert>
  Result<std::optional<Domain>> Apply(const conav_msgs::msg::MessageChange& change,
                                      Convert& convert) {
    return decoder_.Decode(change).and_then(
        [&](const auto& payload) -> Result<std::optional<Domain>> {
          if (!payload) return std::nullopt;
          T message;
          if (!FromPayload(TypeSupportOf<T>(), *payload, &message)) {
            return Fail(ErrorCode::kMalformed,
                        "the changed bytes are no " + TypeSupportOf<T>().name);
          }
          return convert(std::move(message)).map([](Domain value) {
            return std::optional(std::move(value));
          });
        });
  }

  Participant& participant_;
  const Topic<T> topic_;
  const std::string entity_;
  std::optional<Subscriber<T>> whole_;
  std::optional<Subscriber<conav_msgs::msg::MessageChange>> changes_;
  ChangeDecoder decoder_;
  const void* newest_ = nullptr;  // whole_ or changes_, which the newest message came from
  SourceTime newest_time_{};
};

}  // namespace conav::bus
