// The files of deploy/ros2 against the table of topics. RViz and Foxglove themselves are not run.
#include <yaml-cpp/yaml.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <regex>
#include <set>

#include "common/bus/topics.h"
#include "common/bus/type_support.h"
#include "common/grid/frames.h"
#include "common/runtime/file.h"

namespace conav {
namespace {

const std::string kFolder = std::string(CONAV_SOURCE_DIR) + "/deploy/ros2/";

struct Entry {
  std::string type;  // "nav_msgs/OccupancyGrid"
  bus::Qos qos;
};

/// All topics of robots r1 and r2 in world w1, by name.
std::map<std::string, Entry> Table() {
  std::map<std::string, Entry> table;
  const auto add_for = [&](const std::string& entity) {
    return [&table, entity](const auto& topic) {
      using T = typename std::decay_t<decltype(topic)>::Type;
      const std::string& name = bus::TypeSupportOf<T>().name;  // "nav_msgs::msg::dds_::Path_"
      const auto last = name.rfind("::") + 2;
      table[topic.NameFor(entity)] = {
          name.substr(0, name.find("::")) + "/" + name.substr(last, name.size() - last - 1),
          topic.qos};
    };
  };
  for (const char* robot : {"r1", "r2"}) bus::ForEachRobotTopic(add_for(robot));
  bus::ForEachWorldTopic(add_for("w1"));
  bus::ForEachSystemTopic(add_for(""));
  return table;
}

/// What a display or tool of RViz subscribes to or publishes.
const std::map<std::string, std::string> kRvizTypes{
    {"rviz_default_plugins/Map", "nav_msgs/OccupancyGrid"},
    {"rviz_default_plugins/MarkerArray", "visualization_msgs/MarkerArray"},
    {"rviz_default_plugins/Path", "nav_msgs/Path"},
    {"rviz_default_plugins/Odometry", "nav_msgs/Odometry"},
    {"rviz_default_plugins/Image", "sensor_msgs/CompressedImage"},  // by image_transport
    {"rviz_default_plugins/RobotModel", "std_msgs/String"},
    {"rviz_default_plugins/SetGoal", "geometry_msgs/PoseStamped"}};

/// Checks a display or tool; its topic, empty if it has none.
std::string CheckPlugin(const std::map<std::string, Entry>& table, const YAML::Node& plugin) {
  const YAML::Node topic = plugin["Topic"] ? plugin["Topic"] : plugin["Description Topic"];
  if (!topic) return "";
  const auto name = topic["Value"].as<std::string>();
  const auto type = plugin["Class"].as<std::string>();
  CAPTURE(name, type);
  REQUIRE(table.contains(name));
  const Entry& entry = table.at(name);
  CHECK(kRvizTypes.at(type) == entry.type);
  // A reader that asks for more than is offered gets nothing, and one that asks for less of a
  // latched topic comes too late.
  const bool latched = entry.qos.durability == bus::Durability::kTransientLocal;
  CHECK((topic["Durability Policy"].as<std::string>() == "Transient Local") == latched);
  CHECK(topic["Reliability Policy"].as<std::string>() == "Reliable");
  CHECK(entry.qos.reliability == bus::Reliability::kReliable);
  return name;
}

// Report row 30: ".rviz, URDF, launch file, package.xml, .msg: `find` finds none".
TEST_CASE("RViz's files name topics of conav, with their types and QoS", "[ros2][row30]") {
  const bool fleet = GENERATE(false, true);
  const auto table = Table();
  const YAML::Node manager =
      YAML::LoadFile(kFolder + (fleet ? "fleet.rviz" : "conav.rviz"))["Visualization Manager"];
  CHECK(manager["Global Options"]["Fixed Frame"].as<std::string>() == kMapFrame);
  std::set<std::string> named;
  for (const YAML::Node& display : manager["Displays"]) named.insert(CheckPlugin(table, display));
  for (const YAML::Node& tool : manager["Tools"]) named.insert(CheckPlugin(table, tool));
  const std::vector<std::string> robots =
      fleet ? std::vector<std::string>{"r1", "r2"} : std::vector<std::string>{"r1"};
  for (const std::string& robot : robots) {
    for (const char* topic :
         {"/map", "/plan", "/robot_description", "/camera/image/compressed", "/goal_pose"}) {
      CHECK(named.contains("/" + robot + topic));
    }
  }
  int models = 0;
  for (const YAML::Node& display : manager["Displays"]) {
    if (!display["TF Prefix"]) continue;
    ++models;
    const auto prefix = display["TF Prefix"].as<std::string>();
    CHECK(prefix == (fleet ? display["Name"].as<std::string>() : ""));
  }
  CHECK(models == static_cast<int>(robots.size()));
}

/// Every text of `node` and below that is the name of a topic, perhaps with fields behind it.
void CollectTopics(const YAML::Node& node, std::vector<std::string>& topics) {
  if (node.IsScalar()) {
    const auto text = node.as<std::string>();
    if (text.starts_with("/")) topics.push_back(text.substr(0, text.find('.')));
    return;
  }
  for (const auto& child : node) {
    if (!node.IsMap()) {
      CollectTopics(child, topics);
      continue;
    }
    CollectTopics(child.first, topics);
    CollectTopics(child.second, topics);
  }
}

TEST_CASE(
    "the layout for Foxglove and Lichtblick names topics of conav, with the types of its panels",
    "[ros2][row30]") {
  const auto table = Table();
  const YAML::Node layout = YAML::LoadFile(kFolder + "layout.json");  // JSON is YAML
  std::vector<std::string> topics;
  CollectTopics(layout["configById"], topics);
  CHECK(topics.size() > 12);
  for (const std::string& topic : topics) {
    CAPTURE(topic);
    CHECK(table.contains(topic));
  }
  const YAML::Node panels = layout["configById"];
  for (const char* robot : {"r1", "r2"}) {
    const YAML::Node image = panels[std::string("Image!") + robot]["imageMode"];
    CHECK(table.at(image["imageTopic"].as<std::string>()).type == "sensor_msgs/CompressedImage");
    CHECK(table.at(image["calibrationTopic"].as<std::string>()).type == "sensor_msgs/CameraInfo");
    const YAML::Node urdf = panels["3D!conav"]["layers"][std::string("urdf-") + robot];
    CHECK(table.at(urdf["topic"].as<std::string>()).type == "std_msgs/String");
    CHECK(urdf["framePrefix"].as<std::string>() == FrameId(robot, ""));
  }
  const auto goal = panels["3D!conav"]["publish"]["poseTopic"].as<std::string>();
  CHECK(table.at(goal).type == "geometry_msgs/PoseStamped");
  for (const auto& topic : panels["3D!conav"]["topics"]) {
    const std::string& type = table.at(topic.first.as<std::string>()).type;
    CHECK((type == "nav_msgs/OccupancyGrid" || type == "nav_msgs/Path" ||
           type == "visualization_msgs/MarkerArray"));
  }
  // Each panel of the arrangement has its settings.
  const std::string arrangement = YAML::Dump(layout["layout"]);
  for (const auto& panel : panels) {
    CHECK_THAT(arrangement, Catch::Contains(panel.first.as<std::string>()));
  }
}

TEST_CASE("the launch file is Python, its files are there and its topics are conav's",
          "[ros2][row30]") {
  const std::string file = kFolder + "conav.launch.py";
  const std::string compile =
      "python3 -c 'import ast, sys; ast.parse(open(sys.argv[1]).read())' '" + file + "'";
  CHECK(std::system(compile.c_str()) == 0);
  const auto text = ReadFile(file);
  REQUIRE(text);
  const std::regex quoted("\"([^\"]*)\"");
  const auto table = Table();
  std::set<std::string> files;
  std::set<std::string> topics;
  for (std::sregex_iterator match(text->begin(), text->end(), quoted), end; match != end; ++match) {
    const std::string word = (*match)[1];
    if (word.ends_with(".rviz") && word != ".rviz") files.insert(word);
    if (word.starts_with("/") && !word.ends_with("/")) {
      topics.insert(std::regex_replace(word, std::regex("\\{robot\\}"), "r1"));
    }
  }
  CHECK(files == std::set<std::string>{"conav.rviz", "fleet.rviz"});
  for (const std::string& name : files) CHECK(std::filesystem::exists(kFolder + name));
  CHECK(topics == std::set<std::string>{"/tf", "/tf_static", "/r1/tf", "/r1/tf_static"});
  for (const std::string& topic : topics) {
    CHECK(table.at(topic).type == "tf2_msgs/TFMessage");
  }
}

}  // namespace
}  // namespace conav
