#include "common/service/node_services.h"

#include <chrono>
#include <mutex>
#include <utility>

#include "common/bus/publisher.h"
#include "common/bus/ros_graph.h"
#include "common/bus/service.h"
#include "common/service/diagnostics.h"

namespace conav {
namespace {

namespace srv = rcl_interfaces::srv;

/// How often to look whether replies wait for a client that is just being discovered.
constexpr std::chrono::milliseconds kLook{100};

/// lifecycle_msgs/msg/State
lifecycle_msgs::msg::State State(bool active) {
  constexpr std::uint8_t kInactive = 2;
  constexpr std::uint8_t kActive = 3;
  lifecycle_msgs::msg::State state;
  state.id(active ? kActive : kInactive);
  state.label(active ? "active" : "inactive");
  return state;
}

}  // namespace

class NodeServices::Servers {
 public:
  Servers(bus::Participant& participant, std::vector<ConfigParameter> parameters)
      : name_(bus::RosName(participant.node_name())),
        parameters_(std::move(parameters)),
        state_(participant, bus::kGetStateService, name_, &notifier_),
        list_(participant, bus::kListParametersService, name_, &notifier_),
        describe_(participant, bus::kDescribeParametersService, name_, &notifier_),
        get_(participant, bus::kGetParametersService, name_, &notifier_),
        types_(participant, bus::kGetParameterTypesService, name_, &notifier_),
        set_(participant, bus::kSetParametersService, name_, &notifier_),
        set_atomically_(participant, bus::kSetParametersAtomicallyService, name_, &notifier_),
        events_(participant, bus::kParameterEvents) {}

  void SetApply(Parameters::Apply apply, bool active) {
    const std::lock_guard lock(mutex_);
    parameters_.SetApply(std::move(apply));
    if (active && !active_) {
      auto event = NewEvent();
      event.new_parameters(parameters_.All());
      bus::Send(events_, event);
    }
    active_ = active;
  }

  void Turn() {
    const std::lock_guard lock(mutex_);
    state_.Serve([this](const auto&) {
      lifecycle_msgs::srv::GetState_Response response;
      response.current_state(State(active_));
      return response;
    });
    list_.Serve([this](const srv::ListParameters_Request& request) {
      srv::ListParameters_Response response;
      response.result(parameters_.List(request));
      return response;
    });
    describe_.Serve([this](const srv::DescribeParameters_Request& request) {
      srv::DescribeParameters_Response response;
      response.descriptors(parameters_.Describe(request.names()));
      return response;
    });
    get_.Serve([this](const srv::GetParameters_Request& request) {
      srv::GetParameters_Response response;
      response.values(parameters_.Get(request.names()));
      return response;
    });
    types_.Serve([this](const srv::GetParameterTypes_Request& request) {
      srv::GetParameterTypes_Response response;
      response.types(parameters_.Types(request.names()));
      return response;
    });
    set_.Serve([this](const srv::SetParameters_Request& request) {
      srv::SetParameters_Response response;
      for (const auto& change : request.parameters()) response.results().push_back(Set({change}));
      return response;
    });
    set_atomically_.Serve([this](const srv::SetParametersAtomically_Request& request) {
      srv::SetParametersAtomically_Response response;
      response.result(Set(request.parameters()));
      return response;
    });
  }

  bus::Notifier& notifier() { return notifier_; }

 private:
  rcl_interfaces::msg::ParameterEvent NewEvent() const {
    rcl_interfaces::msg::ParameterEvent event;
    event.stamp(RosWallTime(std::chrono::system_clock::now()));
    event.node("/" + name_);
    return event;
  }

  rcl_interfaces::msg::SetParametersResult Set(
      const std::vector<rcl_interfaces::msg::Parameter>& changes) {
    auto result = parameters_.Set(changes);
    if (!result.successful()) return result;
    auto event = NewEvent();
    event.changed_parameters(changes);
    bus::Send(events_, event);
    for (const auto& change : changes) LOG_INFO("parameter set", "name", change.name());
    return result;
  }

  bus::Notifier notifier_;
  const std::string name_;
  std::mutex mutex_;  // guards all below
  Parameters parameters_;
  bool active_ = false;
  bus::ServiceServer<lifecycle_msgs::srv::GetState_Request, lifecycle_msgs::srv::GetState_Response>
      state_;
  bus::ServiceServer<srv::ListParameters_Request, srv::ListParameters_Response> list_;
  bus::ServiceServer<srv::DescribeParameters_Request, srv::DescribeParameters_Response> describe_;
  bus::ServiceServer<srv::GetParameters_Request, srv::GetParameters_Response> get_;
  bus::ServiceServer<srv::GetParameterTypes_Request, srv::GetParameterTypes_Response> types_;
  bus::ServiceServer<srv::SetParameters_Request, srv::SetParameters_Response> set_;
  bus::ServiceServer<srv::SetParametersAtomically_Request, srv::SetParametersAtomically_Response>
      set_atomically_;
  bus::Publisher<rcl_interfaces::msg::ParameterEvent> events_;
};

NodeServices::NodeServices(bus::Participant& participant, std::vector<ConfigParameter> parameters)
    : servers_(std::make_unique<Servers>(participant, std::move(parameters))),
      thread_([this] { Run(); }) {}

NodeServices::~NodeServices() {
  stopping_ = true;
  servers_->notifier().Notify();
  thread_.join();
}

NodeServices::Running::Running(NodeServices& services, Parameters::Apply apply)
    : services_(services) {
  services_.servers_->SetApply(std::move(apply), true);
}

NodeServices::Running::~Running() { services_.servers_->SetApply(nullptr, false); }

void NodeServices::Run() {
  while (!stopping_) {
    servers_->Turn();
    servers_->notifier().Wait(kLook);
  }
}

}  // namespace conav
