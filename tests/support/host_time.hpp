// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace rths::test {

/// Time that the host has granted to this process since the first call [s]: wall time, times the
/// share of a processor that is left for one more process, times that by which the host is late to
/// wake a thread. On an idle host, it is the wall time. Deadlines of tests count it, so that they
/// do not depend on other work of the host. Any thread.
[[nodiscard]] double host_time();

}  // namespace rths::test
