# Untested. The program and the library, from a source archive of tools/package.
class Miebrdf < Formula
  desc "From a material's complex refractive index to its spectral BRDF"
  homepage "https://github.com/miebrdf/miebrdf"
  url "https://github.com/miebrdf/miebrdf/releases/download/v1.0.0/miebrdf-1.0.0.tar.gz"
  # sha256: that of SHA256SUMS of the release
  license "Apache-2.0"

  depends_on "boost" => :build
  depends_on "cli11" => :build
  depends_on "cmake" => :build
  depends_on "eigen" => :build
  depends_on "ninja" => :build
  depends_on "nlohmann-json" => :build
  depends_on "pkg-config" => :build
  depends_on "tomlplusplus" => :build
  depends_on "fmt"
  depends_on "libsodium"
  depends_on "libyaml"
  depends_on "libzip"
  depends_on :linux
  depends_on "muparser"
  depends_on "openexr"
  depends_on "pugixml"
  depends_on "sqlite"
  depends_on "tbb"

  def install
    system "cmake", "-S", ".", "-B", "build", "-G", "Ninja", "-DMIEBRDF_UNITY=ON", "-DBUILD_TESTING=OFF",
           "-DMIEBRDF_BUILD_PYTHON=OFF", *std_cmake_args
    system "cmake", "--build", "build"
    system "cmake", "--install", "build"
  end

  test do
    assert_match "plane_albedo", shell_output("#{bin}/miebrdf albedo --base hg:0.9,0.4 --wavelengths 550 --mu-in 0.5")
  end
end
