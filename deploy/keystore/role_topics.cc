#include <fmt/core.h>
#include <fnmatch.h>

#include <algorithm>
#include <map>

#include "common/bus/network.h"
#include "common/bus/ros_graph.h"
#include "common/bus/service.h"
#include "common/bus/services.h"
#include "common/bus/topics.h"
#include "common/runtime/result.h"
#include "keystore/keystore.h"

namespace conav::keystore {
namespace {

using Roles = std::vector<std::string_view>;

constexpr std::string_view kDoctor = "doctor";

/// By the first word of an item: "planner (teleoperation)", "planner in the mapping task".
const Roles& RolesOf(std::string_view word) {
  static const std::map<std::string_view, Roles> known{
      {"all", Roles(kRoles.begin(), kRoles.end())},
      {"anyone", {"operator", "planner", "tools"}},
      {"clients", {"simulated_operator", "tools"}},
      {"driver", {"driver"}},
      {"launcher", {"launcher"}},
      {"nhpm", {"nhpm"}},
      {"operator", {"operator"}},
      {"operator's", {"operator", "simulated_operator"}},
      {"planner", {"planner"}},
      {"planners", {"planner"}},
      {"recorder", {"recorder"}},
      {"robot", {"sim", "driver"}},
      {"sim", {"sim"}},
      {"sims", {"sim"}},
      {"tools", {"tools"}}};
  const auto found = known.find(word);
  if (found != known.end()) return found->second;
  throw StartupError(fmt::format("the table of topics names '{}', which is no program", word));
}

/// "sim (episode) or operator (field)" -> its first words.
std::vector<std::string_view> WordsIn(std::string_view side) {
  std::vector<std::string_view> words;
  while (!side.empty()) {
    const auto end = std::min({side.find(','), side.find(';'), side.find(" or ")});
    std::string_view item = side.substr(0, end);
    item.remove_prefix(std::min(item.find_first_not_of(' '), item.size()));
    words.push_back(item.substr(0, item.find(' ')));
    if (end == std::string_view::npos) break;
    side.remove_prefix(end + (side[end] == ' ' ? 4 : 1));
  }
  return words;
}

bool Contains(const auto& values, const auto& value) {
  return std::ranges::find(values, value) != values.end();
}

bool ReadsAll(std::string_view role) {
  return Contains(RolesOf("operator"), role) || Contains(RolesOf("recorder"), role) ||
         Contains(RolesOf("launcher"), role) || role == kDoctor || role == "tools";
}

/// The doctor sends what planner and operator send to a robot: it does their part, without them.
bool IsSentByDoctor(std::string_view pattern) {
  return pattern == bus::kRobotCommand.pattern || pattern == bus::kStopOrder.pattern;
}

enum class Entity { kRobot, kOther };

/// The DDS names of a ROS name with "{}".
std::vector<std::string> Fill(std::string_view pattern, const std::vector<std::string>& entities) {
  std::vector<std::string> names;
  for (const std::string& entity : entities) {
    names.push_back(bus::DdsTopicName(bus::FillName(pattern, entity)));
    if (pattern.find("{}") == std::string_view::npos) break;
  }
  return names;
}

void Append(std::vector<std::string>& names, std::vector<std::string> more) {
  for (std::string& name : more) {
    if (!Contains(names, name)) names.push_back(std::move(name));
  }
}

class Grants {
 public:
  Grants(std::string_view role, const GrantOptions& options)
      : role_(role), robots_(options.robots.empty() ? any_ : options.robots) {}

  template <class Topic>
  void AddTopic(const Topic& topic, Entity entity) {
    const auto arrow = topic.direction.find(" -> ");
    const std::string_view from = topic.direction.substr(0, arrow);
    const std::string_view to = topic.direction.substr(arrow + 4);
    const auto& own = entity == Entity::kRobot ? robots_ : any_;
    const bool publishes =
        Contains(RolesIn(from), role_) || (role_ == kDoctor && IsSentByDoctor(topic.pattern));
    const bool is_addressed = Contains(WordsIn(to), std::string_view("robot"));
    const bool subscribes = Contains(RolesIn(to), role_) || ReadsAll(role_);
    Note(publishes, Fill(topic.pattern, own), grant_.publish, grant_.never_publish);
    Note(subscribes, Fill(topic.pattern, is_addressed ? own : any_), grant_.subscribe,
         grant_.never_subscribe);
  }

  /// A service or action with its server; tools are the clients.
  void AddService(const std::string& name, std::string_view server, Entity entity) {
    const auto& own = entity == Entity::kRobot ? robots_ : any_;
    for (const std::string& robot : own) {
      const std::string filled = bus::FillName(name, robot);
      const std::string request = bus::RequestTopic(filled);
      const std::string reply = bus::ReplyTopic(filled);
      const bool serves = Contains(RolesIn(server), role_);
      Note(serves, {reply}, grant_.publish, grant_.never_publish);
      Note(serves || ReadsAll(role_), {request}, grant_.subscribe, grant_.never_subscribe);
      if (role_ == "tools") Append(grant_.publish, {request});
      if (role_ == "tools") Append(grant_.subscribe, {reply});
    }
  }

  void AddAction(const std::string& name, std::string_view server, Entity entity) {
    for (const char* part : {"send_goal", "cancel_goal", "get_result"}) {
      AddService(fmt::format("{}/_action/{}", name, part), server, entity);
    }
    const bool serves = Contains(RolesIn(server), role_);
    for (const char* part : {"feedback", "status"}) {
      const auto names =
          Fill(fmt::format("{}/_action/{}", name, part), entity == Entity::kRobot ? robots_ : any_);
      if (serves) Append(grant_.publish, names);
      if (ReadsAll(role_)) Append(grant_.subscribe, names);
    }
  }

  void AddOther(const std::string& topic) {
    for (auto* names : {&grant_.publish, &grant_.subscribe}) {
      Append(*names, {bus::DdsTopicName(topic)});
      for (const char* prefix : {"rt", "rq", "rr"}) {
        Append(*names, {fmt::format("{}{}/_action/*", prefix, topic)});
      }
    }
  }

  /// The graph of ROS 2, and of what is not allowed what a pattern that is allowed would match: "*" also
  /// stands for "w1/belief".
  Grant Finish() {
    for (auto* names : {&grant_.publish, &grant_.subscribe}) {
      Append(*names, {std::string(bus::kRosDiscoveryInfo.pattern)});
    }
    KeepMatched(grant_.never_publish, grant_.publish);
    KeepMatched(grant_.never_subscribe, grant_.subscribe);
    return std::move(grant_);
  }

 private:
  static void Note(bool allowed, std::vector<std::string> names,
                   std::vector<std::string>& if_allowed, std::vector<std::string>& if_not) {
    Append(allowed ? if_allowed : if_not, std::move(names));
  }
  static void KeepMatched(std::vector<std::string>& never,
                          const std::vector<std::string>& allowed) {
    std::erase_if(never, [&](const std::string& name) {
      return Contains(allowed, name) ||
             std::ranges::none_of(allowed, [&](const std::string& pattern) {
               return fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
             });
    });
  }

  const std::vector<std::string> any_{"*"};
  const std::string_view role_;
  const std::vector<std::string> robots_;
  Grant grant_;
};

std::string TopicsXml(const char* verb, const std::vector<std::string>& topics) {
  if (topics.empty()) return {};
  std::string xml = fmt::format("        <{}>\n          <topics>\n", verb);
  for (const std::string& topic : topics) {
    xml += fmt::format("            <topic>{}</topic>\n", topic);
  }
  return xml + fmt::format("          </topics>\n        </{}>\n", verb);
}

std::string RuleXml(const char* rule, const std::vector<std::string>& publish,
                    const std::vector<std::string>& subscribe) {
  if (publish.empty() && subscribe.empty()) return {};
  return fmt::format(
      "      <{0}>\n        <domains><id_range><min>0</min><max>230</max></id_range></domains>\n"
      "{1}{2}      </{0}>\n",
      rule, TopicsXml("publish", publish), TopicsXml("subscribe", subscribe));
}

constexpr const char* kXmlHead =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<dds xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" "
    "xsi:noNamespaceSchemaLocation=\"http://www.omg.org/spec/DDS-SECURITY/20170901/"
    "omg_shared_ca_{}.xsd\">\n";

}  // namespace

std::vector<std::string_view> RolesIn(std::string_view side) {
  Roles roles;
  for (const std::string_view word : WordsIn(side)) {
    const Roles& named = RolesOf(word);
    roles.insert(roles.end(), named.begin(), named.end());
  }
  return roles;
}

Grant GrantOf(std::string_view role, const GrantOptions& options) {
  Grants grants(role, options);
  bus::ForEachRobotTopic([&](const auto& topic) { grants.AddTopic(topic, Entity::kRobot); });
  bus::ForEachWorldTopic([&](const auto& topic) { grants.AddTopic(topic, Entity::kOther); });
  bus::ForEachSystemTopic([&](const auto& topic) { grants.AddTopic(topic, Entity::kOther); });
  const auto entity_of = [](const auto& offered) {
    return offered.entity == "robot" ? Entity::kRobot : Entity::kOther;
  };
  bus::ForEachService([&](const auto& service) {
    grants.AddService(std::string(service.pattern), service.server, entity_of(service));
  });
  bus::ForEachAction([&](const auto& action) {
    grants.AddAction(std::string(action.pattern), action.server, entity_of(action));
  });
  for (const std::string& topic : options.topics) grants.AddOther(topic);
  return grants.Finish();
}

std::string PermissionsXml(const Grant& grant, const std::string& enclave,
                           const std::string& subject, const std::string& end) {
  return fmt::format(fmt::runtime(kXmlHead), "permissions") +
         fmt::format(
             "  <permissions>\n    <grant name=\"{}\">\n      <subject_name>{}</subject_name>\n"
             "      <validity>\n        <not_before>2020-01-01T00:00:00</not_before>\n"
             "        <not_after>{}</not_after>\n      </validity>\n"
             "{}{}      <default>DENY</default>\n    </grant>\n  </permissions>\n</dds>\n",
             enclave, subject, end,
             RuleXml("deny_rule", grant.never_publish, grant.never_subscribe),
             RuleXml("allow_rule", grant.publish, grant.subscribe));
}

std::string GovernanceXml() {
  return fmt::format(fmt::runtime(kXmlHead), "governance") +
         R"(  <domain_access_rules>
    <domain_rule>
      <domains><id_range><min>0</min><max>230</max></id_range></domains>
      <allow_unauthenticated_participants>false</allow_unauthenticated_participants>
      <enable_join_access_control>true</enable_join_access_control>
      <discovery_protection_kind>ENCRYPT</discovery_protection_kind>
      <liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>
      <rtps_protection_kind>NONE</rtps_protection_kind>
      <topic_access_rules>
        <topic_rule>
          <topic_expression>*</topic_expression>
          <enable_discovery_protection>true</enable_discovery_protection>
          <enable_liveliness_protection>true</enable_liveliness_protection>
          <enable_read_access_control>true</enable_read_access_control>
          <enable_write_access_control>true</enable_write_access_control>
          <metadata_protection_kind>ENCRYPT</metadata_protection_kind>
          <data_protection_kind>ENCRYPT</data_protection_kind>
        </topic_rule>
      </topic_access_rules>
    </domain_rule>
  </domain_access_rules>
</dds>
)";
}

}  // namespace conav::keystore
