// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/yaml_reader.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <map>
#include <sstream>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>

#include "ydd/base/files.h"

namespace ydd {
namespace {

constexpr std::size_t kLargestYaml = std::size_t{4} << 20;
constexpr std::size_t kDeepestYaml = 32;
constexpr std::size_t kMostValues = 100'000;

/// Walks through the text before anything is built of it. An alias counts as all the values that
/// it stands for: nested ones double with every level.
class BoundsCheck : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& mark) override { document_ = mark; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { value(mark, anchor); }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                const std::string&) override {
    has_content_ = true;
    value(mark, anchor);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto named = values_of_.find(anchor);
    if (named == values_of_.end()) {
      throw YAML::ParserException(mark, "an alias stands inside of what it names");
    }
    count(mark, named->second);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(mark, anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(mark, anchor);
  }
  void OnMapEnd() override { close(); }

  bool has_content() const { return has_content_; }
  const YAML::Mark& document() const { return document_; }

 private:
  struct Open {
    YAML::anchor_t anchor;
    std::size_t values_before;
  };

  void count(const YAML::Mark& mark, std::size_t more) {
    values_ += more;
    if (values_ <= kMostValues) return;
    throw YAML::ParserException(mark,
                                fmt::format("more than {} values, aliases resolved", kMostValues));
  }
  void value(const YAML::Mark& mark, YAML::anchor_t anchor) {
    count(mark, 1);
    if (anchor != YAML::NullAnchor) values_of_[anchor] = 1;
  }
  void open(const YAML::Mark& mark, YAML::anchor_t anchor) {
    has_content_ = true;
    open_.push_back({anchor, values_});
    if (open_.size() > kDeepestYaml) {
      throw YAML::ParserException(mark, fmt::format("nested in more than {} levels", kDeepestYaml));
    }
    count(mark, 1);
  }
  void close() {
    const Open closed = open_.back();
    open_.pop_back();
    if (closed.anchor != YAML::NullAnchor) {
      values_of_[closed.anchor] = values_ - closed.values_before;
    }
  }

  std::vector<Open> open_;
  std::map<YAML::anchor_t, std::size_t> values_of_;
  std::size_t values_ = 0;
  bool has_content_ = false;
  YAML::Mark document_;
};

/// @throws YAML::ParserException
void check_bounds(const std::string& text) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  BoundsCheck first;
  if (!parser.HandleNextDocument(first)) return;
  // A "---" at the end, as tools print between two messages, starts an empty one.
  for (int read_to = first.document().pos;;) {
    BoundsCheck next;
    if (!parser.HandleNextDocument(next)) return;
    // yaml-cpp takes a lone comma or bracket for an empty document, again and again.
    if (!next.has_content() && next.document().pos <= read_to) {
      throw YAML::ParserException(next.document(), "a comma or bracket that belongs to nothing");
    }
    read_to = next.document().pos;
    if (next.has_content()) {
      throw YAML::ParserException(next.document(), "a second document starts; keep one");
    }
  }
}

bool same_number(const std::string& a, const std::string& b) {
  const auto number = [](const std::string& text, double& value) {
    const auto [end, ec] = std::from_chars(text.data(), text.data() + text.size(), value);
    return ec == std::errc() && end == text.data() + text.size();
  };
  double value_a = 0;
  double value_b = 0;
  return number(a, value_a) && number(b, value_b) && value_a == value_b;
}

bool same_value(const YAML::Node& a, const YAML::Node& b) {
  if (a.IsScalar() && b.IsScalar()) {
    return a.Scalar() == b.Scalar() || same_number(a.Scalar(), b.Scalar());
  }
  return YAML::Dump(a) == YAML::Dump(b);
}

std::string shown(const YAML::Node& value) {
  return value.IsScalar() ? fmt::format("'{}'", on_one_line(value.Scalar())) : "a list or map";
}

}  // namespace

/// The depth is bounded by `check_bounds`.
Result<void> check_keys_differ(const YAML::Node& node, const std::string& source) {
  if (!node.IsMap() && !node.IsSequence()) return {};
  std::map<std::string, std::pair<YAML::Node, YAML::Node>> seen;
  for (const auto& entry : node) {
    const YAML::Node value = node.IsMap() ? entry.second : entry;
    if (node.IsMap() && entry.first.IsScalar()) {
      const auto [first, is_new] =
          seen.try_emplace(entry.first.Scalar(), entry.first, entry.second);
      if (!is_new && !same_value(first->second.second, value)) {
        return Error{fmt::format("{}: '{}' is {} here and {} in line {}; keep one",
                                 yaml_line(source, entry.first), on_one_line(first->first),
                                 shown(value), shown(first->second.second),
                                 first->second.first.Mark().line + 1)};
      }
    }
    if (auto r = check_keys_differ(value, source); !r) return r;
  }
  return {};
}

namespace {

/// Where `line` has a "key:value" without the blank that YAML wants after the colon; npos if not.
std::size_t bare_colon(std::string_view line) {
  const std::size_t begin = line.find_first_not_of(' ');
  if (begin == line.npos || std::isalpha(static_cast<unsigned char>(line[begin])) == 0) {
    return line.npos;
  }
  const auto is_key = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '_' || c == '-';
  };
  std::size_t end = begin;
  while (end < line.size() && is_key(line[end])) ++end;
  const bool is_bare = end + 1 < line.size() && line[end] == ':' &&
                       std::isspace(static_cast<unsigned char>(line[end + 1])) == 0;
  return is_bare ? end : line.npos;
}

/// A file that starts with "%YAML:1.0" is in OpenCV's dialect: that line is no directive of YAML,
/// and "key:value" needs no blank. Line numbers stay.
std::string in_plain_yaml(std::string text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
  if (!text.starts_with("%YAML:")) return text;
  std::string out;
  std::string_view rest = text;
  rest.remove_prefix(std::min(rest.find('\n'), rest.size()));
  while (!rest.empty()) {
    const std::string_view line = rest.substr(0, std::min(rest.find('\n'), rest.size() - 1) + 1);
    rest.remove_prefix(line.size());
    const std::size_t colon = bare_colon(line);
    if (colon == line.npos) {
      out += line;
    } else {
      out.append(line.substr(0, colon + 1)).append(" ").append(line.substr(colon + 1));
    }
  }
  return out;
}

}  // namespace

std::string yaml_line(const std::string& source, const YAML::Node& node) {
  return fmt::format("{}:{}", source, node.Mark().line + 1);
}

Result<YAML::Node> parse_yaml(const std::string& text, const std::string& source, Keys keys) {
  if (text.size() > kLargestYaml) {
    return Error{fmt::format("{}: {} bytes, more than such a file can need ({})", source,
                             text.size(), kLargestYaml)};
  }
  if (text.find('\0') != std::string::npos) {
    return Error{fmt::format("{}: not a text file: it holds a zero byte", source)};
  }
  try {
    const std::string yaml = in_plain_yaml(text);
    check_bounds(yaml);
    const YAML::Node root = YAML::Load(yaml);
    if (keys == Keys::may_contradict) return root;
    if (auto differ = check_keys_differ(root, source); !differ) return differ.error();
    return root;
  } catch (const YAML::Exception& e) {
    return Error{
        fmt::format("{}:{}: not valid YAML: {}", source, e.mark.line + 1, on_one_line(e.msg))};
  }
}

Result<YAML::Node> read_yaml(const std::filesystem::path& file, Keys keys) {
  std::error_code failure;
  const auto status = std::filesystem::status(file, failure);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    return Error{fmt::format("{}: not a file but a folder, pipe or device", file.string())};
  }
  if (const auto bytes = std::filesystem::file_size(file, failure);
      !failure && bytes > kLargestYaml) {
    return Error{fmt::format("{}: {} bytes, more than such a file can need ({})", file.string(),
                             bytes, kLargestYaml)};
  }
  const Result<std::string> text = read_file(file);
  if (!text) return text.error();
  return parse_yaml(*text, file.string(), keys);
}

}  // namespace ydd
