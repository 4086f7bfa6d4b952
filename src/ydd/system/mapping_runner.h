// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "ydd/mapping/mapper.h"

namespace ydd {

/// Puts the mapper somewhere: into the caller's thread, or into one of its own.
class MappingRunner {
 public:
  virtual ~MappingRunner() = default;
  /// Hands over a candidate. False if the mapper is too far behind to take it. A candidate that
  /// starts a map is always taken, and the map is there when the call returns.
  virtual bool submit(KeyFrameCandidate candidate) = 0;
  /// Nothing waits and nothing is being worked on.
  virtual bool idle() const = 0;
  /// The newest published map; never null.
  virtual std::shared_ptr<const Atlas> atlas() const = 0;
  /// Works off what waits and stops. Further candidates are refused.
  virtual void finish() = 0;
  /// One report per keyframe, in order; complete after `finish`.
  virtual std::vector<MapperReport> reports() const = 0;
};

/// The mapper in the caller's thread: deterministic.
std::unique_ptr<MappingRunner> make_inline_mapping(Mapper mapper);
/// The mapper in a thread of its own.
std::unique_ptr<MappingRunner> make_threaded_mapping(Mapper mapper);

}  // namespace ydd
