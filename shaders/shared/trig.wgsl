// Sine and cosine of an angle in turns. Twin: src/base/trig.rs.

fn sin_turns(turns: f32) -> f32 {
    let f = turns - floor(turns);
    let q = f * 4.0;
    var x = q - 4.0;
    if q < 1.0 {
        x = q;
    } else if q < 3.0 {
        x = 2.0 - q;
    }
    let x2 = x * x;
    var sum = SINE_QUARTER[7];
    sum = sum * x2 + SINE_QUARTER[6];
    sum = sum * x2 + SINE_QUARTER[5];
    sum = sum * x2 + SINE_QUARTER[4];
    sum = sum * x2 + SINE_QUARTER[3];
    sum = sum * x2 + SINE_QUARTER[2];
    sum = sum * x2 + SINE_QUARTER[1];
    sum = sum * x2 + SINE_QUARTER[0];
    return sum * x;
}

fn cos_turns(turns: f32) -> f32 {
    return sin_turns(turns + 0.25);
}
