// SPDX-License-Identifier: Apache-2.0
#include "parameters.h"

#include <array>
#include <cstdio>

namespace ydd::ros1 {
namespace {

using XmlRpc::XmlRpcValue;

std::string text_of(double value) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.17g", value);
  return text.data();
}

void flatten(const std::string& key, XmlRpcValue value, Assignments& out) {
  switch (value.getType()) {
    case XmlRpcValue::TypeStruct:
      for (auto& [name, inner] : value) {
        flatten(key.empty() ? name : key + "." + name, inner, out);
      }
      return;
    case XmlRpcValue::TypeBoolean:
      out.list.push_back(key + "=" + (static_cast<bool>(value) ? "true" : "false"));
      return;
    case XmlRpcValue::TypeInt:
      out.list.push_back(key + "=" + std::to_string(static_cast<int>(value)));
      return;
    case XmlRpcValue::TypeDouble:
      out.list.push_back(key + "=" + text_of(static_cast<double>(value)));
      return;
    case XmlRpcValue::TypeString:
      out.list.push_back(key + "=" + static_cast<std::string>(value));
      return;
    default:
      out.failure = "parameter " + key + ": is no text, number or truth value";
  }
}

}  // namespace

Assignments assignments_of(const XmlRpcValue& parameters) {
  Assignments out;
  if (parameters.valid() && parameters.getType() == XmlRpcValue::TypeStruct) {
    flatten("", parameters, out);
  }
  return out;
}

}  // namespace ydd::ros1
