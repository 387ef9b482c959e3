// SPDX-License-Identifier: Apache-2.0
#include <rths/broker/detail/process.hpp>

#include <fcntl.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

#include <fmt/format.h>

#include <rths/broker/detail/layout.hpp>
#include <rths/core/error.hpp>

namespace rths::broker {
namespace {

using std::chrono::steady_clock;

constexpr unsigned kPidBits = 22;        // as Linux has at most
constexpr unsigned kNamespaceBits = 21;  // the kernel numbers namespaces from here on:
constexpr std::uint64_t kFirstNamespace = 0xEFF0'0000;
constexpr std::uint64_t kNamespaceMask = (1U << kNamespaceBits) - 1;
constexpr std::uint64_t kRandomMask = (1U << 20U) - 1;
constexpr auto kRemovalTimeout = std::chrono::seconds{1};  // a removal takes microseconds
constexpr auto kPoll = std::chrono::milliseconds{1};

std::uint64_t own_namespace() {
  struct stat status {};
  return stat("/proc/self/ns/pid", &status) == 0 ? status.st_ino - kFirstNamespace : 0;
}

std::uint64_t namespace_of(Claim claim) { return claim >> kPidBits & kNamespaceMask; }

Claim new_claim() {
  const std::uint64_t here = own_namespace() & kNamespaceMask;
  std::uint64_t random = 0;
  if (getrandom(&random, sizeof random, 0) != sizeof random) random = here;
  return (random & kRandomMask) << (kPidBits + kNamespaceBits) | here << kPidBits |
         static_cast<std::uint64_t>(getpid());
}

// Locks of an open file description: they belong to a descriptor, not to a process, so closing
// another descriptor of the same object does not release them.
struct flock lock_of(short type, Claim begin, off_t length) {
  struct flock lock {};
  lock.l_type = type;
  lock.l_whence = SEEK_SET;
  lock.l_start = static_cast<off_t>(begin);
  lock.l_len = length;
  return lock;
}

// Waits while another process removes the object.
void lock_own_claim(int descriptor) {
  for (const auto deadline = steady_clock::now() + kRemovalTimeout;;) {
    struct flock lock = lock_of(F_RDLCK, own_claim(), 1);
    if (fcntl(descriptor, F_OFD_SETLK, &lock) == 0) return;
    if (errno != EAGAIN && errno != EACCES)
      throw Error{fmt::format("it cannot be locked: {}", std::strerror(errno))};
    if (steady_clock::now() >= deadline) throw Error{"another process keeps it locked"};
    std::this_thread::sleep_for(kPoll);
  }
}

// With locks of its own, also of an object that has lost its name.
int open_again(int object) {
  const int descriptor = open(fmt::format("/proc/self/fd/{}", object).c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor < 0) throw Error{fmt::format("it cannot be locked: {}", std::strerror(errno))};
  return descriptor;
}

}  // namespace

// The first process of a namespace may have the id of its parent, so a fork forgets the claim, too.
Claim own_claim() {
  static std::atomic<Claim> claim{0};
  [[maybe_unused]] static const int forgotten =
      pthread_atfork(nullptr, nullptr, [] { claim.store(0); });
  Claim found = claim.load();
  while (pid_of(found) != getpid()) {  // none yet
    const Claim fresh = new_claim();
    if (claim.compare_exchange_weak(found, fresh)) return fresh;
  }
  return found;
}

bool is_of_this_namespace(Claim claim) { return namespace_of(claim) == namespace_of(own_claim()); }

std::string in_words(Claim claim) {
  if (is_of_this_namespace(claim)) return fmt::format("process {}", pid_of(claim));
  return fmt::format("process {} of PID namespace {} (here: {})", pid_of(claim),
                     kFirstNamespace + namespace_of(claim),
                     kFirstNamespace + namespace_of(own_claim()));
}

Membership::Membership(int object) : page_{MAP_FAILED}, self_{own_claim()} {
  const int descriptor = open_again(object);
  try {
    lock_own_claim(descriptor);
    page_ = mmap(nullptr, kPageBytes, PROT_NONE, MAP_SHARED, descriptor, 0);
    if (page_ == MAP_FAILED) throw Error{fmt::format("cannot be mapped: {}", std::strerror(errno))};
    madvise(page_, kPageBytes, MADV_DONTFORK);
  } catch (...) {
    close(descriptor);
    throw;
  }
  close(descriptor);
}

Membership::~Membership() {
  if (self_ == own_claim()) munmap(page_, kPageBytes);
}

// The lock on all bytes is that of a process that removes the object. If the kernel cannot tell,
// the process counts as alive.
bool Members::has(Claim claim) const noexcept {
  if (object_ < 0 || claim == 0 || claim >> 63U != 0) return false;
  struct flock lock = lock_of(F_WRLCK, claim, 1);
  return fcntl(object_, F_OFD_GETLK, &lock) != 0 || lock.l_type == F_RDLCK;
}

bool Members::exclude() const noexcept {
  struct flock lock = lock_of(F_WRLCK, 0, 0);
  return fcntl(object_, F_OFD_SETLK, &lock) == 0;
}

}  // namespace rths::broker
