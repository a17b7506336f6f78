// Prefix sums of rows of one length: every number becomes the sum of those before it in its row.
// One workgroup per row. Host: src/gpu/sum_rows.rs.

// The length of every row, in its first word.
@group(1) @binding(0) var<storage, read> length: array<u32>;
@group(1) @binding(1) var<storage, read_write> rows: array<u32>;
// The sum of each whole row.
@group(1) @binding(2) var<storage, read_write> totals: array<u32>;

var<workgroup> sums: array<u32, WORKGROUP>;

@compute @workgroup_size(WORKGROUP)
fn sum_rows(
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let columns = length[0];
    let row = group.x * columns;
    let share = (columns + WORKGROUP - 1u) / WORKGROUP;
    let first = min(local * share, columns);
    let end = min(first + share, columns);
    var sum = 0u;
    for (var column = first; column < end; column++) {
        sum += rows[row + column];
    }
    sums[local] = sum;
    workgroupBarrier();
    var before = 0u;
    for (var i = 0u; i < local; i++) {
        before += sums[i];
    }
    for (var column = first; column < end; column++) {
        let count = rows[row + column];
        rows[row + column] = before;
        before += count;
    }
    if local == WORKGROUP - 1u {
        totals[group.x] = before;
    }
}
