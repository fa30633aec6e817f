#include <miebrdf/table1.h>

#include <iostream>

void show_table1() {
    using namespace miebrdf;
    const Table1Convention& convention = table1_convention(table1_conventions().front().name);
    Table1Request request;
    request.materials = {"GaP"};
    request.conventions = {convention};
    const Table1Result computed = compute_table1(request);
    for (const Table1Entry& entry : computed.entries)
        std::cout << entry.channel << ": " << entry.factor << ", printed " << *entry.paper << '\n';
    const Table1Row& row = table1_printed().front();
    std::cout << row.material << ' ' << row.factor[0] << '\n';
}
