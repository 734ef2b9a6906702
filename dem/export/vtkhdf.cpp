#include "dem/export/vtkhdf.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <hdf5.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "model/files/output.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

/// A handle of the library; false where a call failed.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {
    if (id_ < 0) throw Error("HDF5 failed; is memory exhausted?");
  }
  ~Handle() { close_(id_); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }  // NOLINT: as the library's own functions take it

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

void need(herr_t status) {
  if (status < 0) throw Error("HDF5 failed; is memory exhausted?");
}

template <class Number>
hid_t type_of() {
  if constexpr (std::is_same_v<Number, double>) return H5T_NATIVE_DOUBLE;
  if constexpr (std::is_same_v<Number, std::int64_t>) return H5T_NATIVE_INT64;
  if constexpr (std::is_same_v<Number, std::uint8_t>) return H5T_NATIVE_UINT8;
}

template <class Number>
void put(hid_t place, const char* name, const std::vector<Number>& values, hsize_t components = 1) {
  const hsize_t shape[2] = {values.size() / components, components};
  const Handle space(H5Screate_simple(components > 1 ? 2 : 1, shape, nullptr), H5Sclose);
  const Handle how(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  need(H5Pset_obj_track_times(how, false));  // the same bytes every time
  const Handle set(H5Dcreate2(place, name, type_of<Number>(), space, H5P_DEFAULT, how, H5P_DEFAULT), H5Dclose);
  need(H5Dwrite(set, type_of<Number>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()));
}

void put_type(hid_t group) {
  const std::string name = "UnstructuredGrid";
  const Handle text(H5Tcopy(H5T_C_S1), H5Tclose), one(H5Screate(H5S_SCALAR), H5Sclose);
  need(H5Tset_size(text, name.size()));
  need(H5Tset_strpad(text, H5T_STR_NULLPAD));
  const Handle type(H5Acreate2(group, "Type", text, one, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  need(H5Awrite(type, text, name.data()));
  const hsize_t two = 2;
  const std::int64_t numbers[2] = {1, 0};
  const Handle pair(H5Screate_simple(1, &two, nullptr), H5Sclose);
  const Handle version(H5Acreate2(group, "Version", H5T_NATIVE_INT64, pair, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  need(H5Awrite(version, H5T_NATIVE_INT64, numbers));
}

void put_snapshot(hid_t file, const Snapshot& snapshot) {
  const Packing& p = snapshot.packing;
  const Handle root(H5Gcreate2(file, "VTKHDF", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  put_type(root);
  const auto n = static_cast<std::int64_t>(p.size());
  std::vector<double> points, velocities;
  std::vector<std::int64_t> connectivity, offsets{0};
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Eigen::Vector3d x = snapshot.position(i), v = snapshot.velocity(i);
    points.insert(points.end(), x.begin(), x.end());
    velocities.insert(velocities.end(), v.begin(), v.end());
    connectivity.push_back(static_cast<std::int64_t>(i));
    offsets.push_back(static_cast<std::int64_t>(i + 1));
  }
  for (const char* count : {"NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"})
    put<std::int64_t>(root, count, {n});
  put(root, "Points", points, 3);
  put(root, "Connectivity", connectivity);
  put(root, "Offsets", offsets);
  put(root, "Types", std::vector<std::uint8_t>(p.size(), 1));  // VTK_VERTEX
  const Handle data(H5Gcreate2(root, "PointData", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  put(data, "id", p.id);
  put(data, "radius", p.radius);
  put(data, "velocity", velocities, 3);
  const Handle fields(H5Gcreate2(root, "FieldData", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  put<double>(fields, "time", {snapshot.time});
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> H = p.H;
  put(fields, "cell", std::vector<double>(H.data(), H.data() + 9));
}

/// The file as bytes, made in memory.
std::string vtkhdf_bytes(const Snapshot& snapshot) {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  need(H5Pset_fapl_core(access, 1 << 20, false));
  const Handle file(H5Fcreate("grainlaw.vtkhdf", H5F_ACC_TRUNC, H5P_DEFAULT, access), H5Fclose);
  put_snapshot(file, snapshot);
  need(H5Fflush(file, H5F_SCOPE_GLOBAL));
  const ssize_t size = H5Fget_file_image(file, nullptr, 0);
  if (size < 0) throw Error("HDF5 failed; is memory exhausted?");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  if (H5Fget_file_image(file, bytes.data(), bytes.size()) != size) throw Error("HDF5 failed; is memory exhausted?");
  return bytes;
}

/// In the child: the bytes into `out`; 0, or why not.
int write_bytes(const Snapshot& snapshot, int out) {
  try {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are said once, by us
    const std::string bytes = vtkhdf_bytes(snapshot);
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t n = ::write(out, bytes.data() + done, bytes.size() - done);
      if (n < 0 && errno != EINTR) return errno;
      done += n < 0 ? 0 : static_cast<std::size_t>(n);
    }
    return 0;
  } catch (...) {
    return ENOMEM;
  }
}

/// A process that makes the bytes, and what comes of it: HDF5 1.10 that finds no memory writes where it may not, and does not end.
class Maker {
 public:
  explicit Maker(const Snapshot& snapshot) {
    if (::pipe2(ends_, O_CLOEXEC) != 0) fail(errno);
    child_ = ::fork();
    if (child_ == 0) {
      const int nowhere = ::open("/dev/null", O_WRONLY);
      if (nowhere >= 0) ::dup2(nowhere, STDERR_FILENO);
      ::_exit(write_bytes(snapshot, ends_[1]));
    }
    const int error = errno;
    ::close(std::exchange(ends_[1], -1));
    if (child_ < 0) {
      end();
      fail(error);
    }
  }
  ~Maker() { end(); }
  Maker(const Maker&) = delete;
  Maker& operator=(const Maker&) = delete;

  std::string bytes() {
    std::string all, part(1 << 16, '\0');
    for (;;) {
      const ssize_t n = ::read(ends_[0], part.data(), part.size());
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) fail(errno);
      if (n == 0) break;
      all.append(part, 0, static_cast<std::size_t>(n));
    }
    const int status = end();
    constexpr int kEndedByHdf5 = 255;
    if (!WIFEXITED(status) || WEXITSTATUS(status) == kEndedByHdf5) fail(ENOMEM);
    if (WEXITSTATUS(status) != 0) fail(WEXITSTATUS(status));
    return all;
  }

 private:
  [[noreturn]] static void fail(int error) { throw Error(fmt::format("HDF5 failed: {}", std::strerror(error))); }

  int end() {
    int status = 0;
    if (ends_[0] >= 0) ::close(std::exchange(ends_[0], -1));  // a child that still writes ends by it
    if (child_ > 0) {
      while (::waitpid(child_, &status, 0) < 0 && errno == EINTR) {
      }
    }
    child_ = -1;
    return status;
  }

  int ends_[2]{-1, -1};
  pid_t child_ = -1;
};

}  // namespace

void write_vtkhdf(const std::filesystem::path& file, const Snapshot& snapshot) {
  std::string bytes;
  try {
    bytes = Maker(snapshot).bytes();
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", file.string(), error.what()));
  }
  write_durably(file, bytes);
}

}  // namespace grainlaw::dem
