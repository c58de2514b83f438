
function jacobian = blocks(rows)
jacobian.by_position = reshape(rows.by_position, 6, 6).';
jacobian.by_velocity = reshape(rows.by_velocity, 6, 6).';
end
