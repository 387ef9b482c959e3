// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <hdf5.h>

#include <rths/core/error.hpp>

namespace rths::recording {

/// An HDF5 identifier, closed by the destructor.
class Handle {
 public:
  using Closer = herr_t (*)(hid_t);
  Handle() = default;
  /// @throws Error "<action> failed" if the identifier is negative
  Handle(hid_t id, Closer closer, const std::string& action) : id_{id}, closer_{closer} {
    if (id < 0) throw Error{action + " failed"};
  }
  Handle(Handle&& other) noexcept : id_{std::exchange(other.id_, -1)}, closer_{other.closer_} {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(closer_, other.closer_);
    return *this;
  }
  ~Handle() {
    if (id_ >= 0) closer_(id_);
  }
  [[nodiscard]] hid_t id() const { return id_; }

 private:
  hid_t id_ = -1;
  Closer closer_ = nullptr;
};

/// @throws Error "<action> failed" for a negative status
inline void check(herr_t status, const std::string& action) {
  if (status < 0) throw Error{action + " failed"};
}

/// Fill values: read where a crash or a full disk prevented a write. Never a measurement.
inline constexpr std::int64_t kNoTime = -1;
inline constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

/// Group of /meta with the data that are added to a finished recording.
inline constexpr const char* kAdditions = "added";
inline constexpr const char* kAddedTexts = "texts";  ///< a group in it
/// Name of the dataset with the number of missing rows.
inline constexpr const char* kRowsMissing = "rows_missing";

/// Disables the library's error output, because `Error` reports failures, and its writes at exit,
/// because the files are already closed. Call it before any other function of the library.
inline void silence_hdf5() {
  H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

/// Properties to open a file without a lock of the library: another program may hold one, and some
/// file systems have none.
[[nodiscard]] Handle without_lock();
/// Opens a file to read it, without a lock if it cannot be locked. This program may have it open in
/// either way already.
/// @param flags  H5F_ACC_RDONLY, or with H5F_ACC_SWMR_READ   @returns negative: it cannot be opened
[[nodiscard]] hid_t open_to_read(const std::filesystem::path& file, unsigned flags);

void write_text_attribute(hid_t object, const std::string& name, const std::string& text);
void write_text_list_attribute(hid_t object, const std::string& name,
                               const std::vector<std::string>& texts);
void write_text_dataset(hid_t group, const std::string& name, const std::string& text);
[[nodiscard]] std::string read_text_attribute(hid_t object, const std::string& name);
[[nodiscard]] std::vector<std::string> read_text_list_attribute(hid_t object,
                                                                const std::string& name);
[[nodiscard]] std::string read_text_dataset(hid_t group, const std::string& name);

}  // namespace rths::recording
