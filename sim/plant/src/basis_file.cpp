// SPDX-License-Identifier: Apache-2.0
#include <rths/plant/basis_file.hpp>

#include <unistd.h>

#include <cstring>
#include <fstream>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/file.hpp>
#include <rths/core/message.hpp>
#include <rths/core/sha256.hpp>

namespace rths::plant {
namespace {

constexpr std::size_t kHashSize = 64;           // digits
constexpr std::uint64_t kMostBytes = 1U << 30;  // of a file
constexpr Index kMostNumbers = 1 << 27;         // of a matrix

std::string title() { return fmt::format("rths plant basis {}\n", kBasisFormat); }

void append(std::string& bytes, const void* data, std::size_t size) {
  bytes.append(static_cast<const char*>(data), size);
}

template <class Matrix>
void append(std::string& bytes, const Matrix& matrix) {
  const std::array<Index, 2> size{matrix.rows(), matrix.cols()};
  append(bytes, size.data(), sizeof size);
  append(bytes, matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(double));
}

/// Takes numbers from bytes; stops at the first that are missing.
class NumbersOfFile {
 public:
  explicit NumbersOfFile(std::string_view rest) : rest_{rest} {}
  [[nodiscard]] bool is_complete() const { return is_sound_ && rest_.empty(); }
  void take(void* data, std::size_t size) {
    is_sound_ = is_sound_ && size <= rest_.size();
    if (!is_sound_) return;
    std::memcpy(data, rest_.data(), size);
    rest_.remove_prefix(size);
  }
  template <class Matrix>
  void take(Matrix& matrix) {
    std::array<Index, 2> size{};
    take(size.data(), sizeof size);
    is_sound_ = is_sound_ && size[0] >= 0 && size[1] >= 0 &&
                size[0] <= kMostNumbers / std::max<Index>(1, size[1]) &&
                (Matrix::ColsAtCompileTime != 1 || size[1] == 1);
    if (!is_sound_) return;
    matrix.resize(size[0], size[1]);
    take(matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(double));
  }

 private:
  std::string_view rest_;
  bool is_sound_ = true;
};

// In the order of the file.
template <class Of, class Visit>
void visit_matrices(Of& basis, const Visit& visit) {
  visit(basis.stiffness);
  visit(basis.bearings);
  visit(basis.floors);
  visit(basis.participation);
  visit(basis.weights);
  visit(basis.frequencies);
  visit(basis.nodes);
  visit(basis.bearing_places);
  visit(basis.shapes);
}

bool fits(const Basis& basis) {
  const Index m = basis.coordinates();
  return basis.bearings.cols() == m && basis.floors.cols() == m &&
         basis.participation.rows() == m && basis.participation.cols() == 3 &&
         basis.bearings.rows() == 3 * basis.weights.size() && basis.frequencies.size() <= m &&
         basis.nodes.rows() == 3 && basis.bearing_places.rows() == 3 &&
         basis.bearing_places.cols() == basis.weights.size() && basis.shapes.cols() <= m &&
         basis.shapes.rows() == 3 * basis.nodes.cols();
}

}  // namespace

std::optional<Basis> read_basis(const std::filesystem::path& file, const std::string& key) try {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return std::nullopt;
  const std::string bytes = read_file(file, kMostBytes);
  const std::string head = title() + sha256(key) + "\n";
  if (bytes.size() < head.size() + kHashSize || !bytes.starts_with(head)) return std::nullopt;
  const std::string_view body =
      std::string_view{bytes}.substr(head.size(), bytes.size() - head.size() - kHashSize);
  if (sha256(body) != std::string_view{bytes}.substr(bytes.size() - kHashSize)) return std::nullopt;
  NumbersOfFile rest{body};
  Basis basis;
  visit_matrices(basis, [&](auto& matrix) { rest.take(matrix); });
  rest.take(basis.mass.data(), sizeof basis.mass);
  rest.take(&basis.dofs, sizeof basis.dofs);
  return rest.is_complete() && fits(basis) ? std::optional{std::move(basis)} : std::nullopt;
} catch (const Error&) {
  return std::nullopt;
}

bool write_basis(const std::filesystem::path& file, const std::string& key, const Basis& basis) {
  std::string body;
  visit_matrices(basis, [&](const auto& matrix) { append(body, matrix); });
  append(body, basis.mass.data(), sizeof basis.mass);
  append(body, &basis.dofs, sizeof basis.dofs);
  std::error_code failed;
  std::filesystem::create_directories(file.parent_path(), failed);
  const std::filesystem::path part = file.string() + fmt::format(".{}.part", getpid());
  std::ofstream stream{part, std::ios::binary};
  stream << title() << sha256(key) << "\n" << body << sha256(body);
  stream.close();
  if (stream) std::filesystem::rename(part, file, failed);
  if (!stream || failed) {
    std::error_code ignored;
    std::filesystem::remove(part, ignored);
    return false;
  }
  return true;
}

Basis basis_for(const std::optional<std::filesystem::path>& folder, const std::string& key,
                const std::function<Basis()>& make) {
  if (!folder) return make();
  const std::filesystem::path file = *folder / (sha256(key).substr(0, 32) + ".basis");
  if (auto known = read_basis(file, key)) return *std::move(known);
  Basis basis = make();
  if (!write_basis(file, key, basis))
    write_message(fmt::format(
        "{}: cannot be written, so the plant's modes are computed each time\n", file.string()));
  return basis;
}

}  // namespace rths::plant
