// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <utility>

#include "parameters.h"
#include "ros_node.h"

namespace {

/// Empty, or why the node had to end.
std::string run() {
  ros::NodeHandle node, private_node("~");
  XmlRpc::XmlRpcValue parameters;
  private_node.getParam(private_node.getNamespace(), parameters);
  const ydd::ros1::Assignments assignments = ydd::ros1::assignments_of(parameters);
  if (!assignments.failure.empty()) return assignments.failure;
  ydd::RobotPort::Opened opened = ydd::RobotPort::open(assignments.list);
  if (!opened.port) return opened.failure;
  ydd::ros1::RosNode ydd_slam(node, private_node, std::move(opened.port));
  return ydd_slam.spin();
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "ydd_slam");
  const std::string failure = run();
  if (failure.empty()) return 0;
  std::fprintf(stderr, "error: %s\n", failure.c_str());
  return 1;
}
