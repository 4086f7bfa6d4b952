// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <xmlrpcpp/XmlRpcValue.h>

namespace ydd::ros1 {

/// Parameters as "key=value", nested ones with dots between.
struct Assignments {
  std::vector<std::string> list;
  std::string failure;  ///< the parameter that is a list or something else that is no option
};
Assignments assignments_of(const XmlRpc::XmlRpcValue& parameters);

}  // namespace ydd::ros1
