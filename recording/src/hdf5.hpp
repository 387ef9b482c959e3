// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <hdf5.h>

#include <rths/core/error.hpp>

namespace rths::recording {

/// An HDF5 identifier that closes itself.
class Handle {
 public:
  using Closer = herr_t (*)(hid_t);
  Handle() = default;
  /// @throws Error "<what> failed" if the library handed out no identifier
  Handle(hid_t id, Closer closer, const std::string& what) : id_{id}, closer_{closer} {
    if (id < 0) throw Error{what + " failed"};
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

/// @throws Error "<what> failed" for a negative status
inline void check(herr_t status, const std::string& what) {
  if (status < 0) throw Error{what + " failed"};
}

/// Keeps the library from printing its own error stack; ours says what matters.
class QuietHdf5 {
 public:
  QuietHdf5() {
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~QuietHdf5() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }
  QuietHdf5(const QuietHdf5&) = delete;
  QuietHdf5& operator=(const QuietHdf5&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

void write_text_attribute(hid_t object, const std::string& name, const std::string& text);
void write_text_list_attribute(hid_t object, const std::string& name,
                               const std::vector<std::string>& texts);
void write_text_dataset(hid_t group, const std::string& name, const std::string& text);
[[nodiscard]] std::string read_text_attribute(hid_t object, const std::string& name);
[[nodiscard]] std::vector<std::string> read_text_list_attribute(hid_t object,
                                                                const std::string& name);
[[nodiscard]] std::string read_text_dataset(hid_t group, const std::string& name);

}  // namespace rths::recording
