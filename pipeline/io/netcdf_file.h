// A NetCDF-4 file as the plug-in netcdf offers it: libnetcdf's calls, with errors as exceptions.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace miebrdf {

/// Variables and dimensions go by the numbers that NetCDF gives them. All functions throw
/// InputError. The destructor closes the file.
class NetcdfFile {
  public:
    using Places = std::vector<std::size_t>;  ///< one for each dimension
    enum class Type { number, byte, integer, text };
    static constexpr int kGlobal = -1;  ///< in place of a variable: the file

    struct Dimension {
        std::string name;
        std::size_t size = 0;
    };

    virtual ~NetcdfFile() = default;
    virtual void create(const std::string& path) = 0;
    virtual void open(const std::string& path) = 0;
    virtual void close() = 0;

    // A file that was created is being defined until its definitions end.
    virtual void begin_definitions() = 0;
    virtual void end_definitions() = 0;
    virtual int define_dimension(const std::string& name, std::size_t size) = 0;
    virtual int define_variable(const std::string& name, Type type,
                                const std::vector<int>& dimensions) = 0;
    /// @param piece  that is compressed together
    virtual void compress(int variable, const Places& piece, int level) = 0;
    virtual void put_text(int variable, const char* name, const std::string& text) = 0;
    virtual void put_number(int variable, const char* name, double value) = 0;
    virtual void put_bytes(int variable, const char* name,
                           const std::vector<signed char>& bytes) = 0;

    // Whole variables, then parts of them.
    virtual void write(int variable, const std::vector<double>& values) = 0;
    virtual void write(int variable, const std::vector<long long>& values) = 0;
    virtual void write(int variable, const std::vector<std::string>& texts) = 0;
    virtual void write(int variable, const Places& start, const Places& count,
                       const double* values) = 0;
    virtual void write(int variable, const Places& at, signed char value) = 0;

    virtual int variables() const = 0;
    virtual std::string name_of(int variable) const = 0;
    virtual int find(const std::string& variable) const = 0;  ///< -1: there is none
    virtual std::vector<int> dimensions_of(int variable) const = 0;
    virtual Dimension dimension(int dimension) const = 0;
    virtual bool is_text(int variable) const = 0;
    /// An attribute; empty if there is none.
    virtual std::string text(int variable, const char* name) const = 0;
    virtual std::vector<double> numbers(int variable, const Places& start,
                                        const Places& count) const = 0;
    virtual std::vector<std::string> texts(int variable, std::size_t size) const = 0;
};

/// Whether the plug-in can be opened.
bool has_netcdf();

/// @param file  the name of the file that messages have
/// @param what  of messages: "write" or "read"
/// @throws UsageError  where the plug-in is missing
std::unique_ptr<NetcdfFile> make_netcdf_file(const std::string& file, const std::string& what);

}  // namespace miebrdf
