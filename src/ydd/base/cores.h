// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace ydd {

/// Processor cores that this process may run on (`taskset`, containers); at least 1.
int available_cores();

}  // namespace ydd
