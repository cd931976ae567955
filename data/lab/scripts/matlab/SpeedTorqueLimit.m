% Task 10: torque over speed of the fastest run-up, against the datasheet's peak curve at 230 V.
v = course_values();
[t, omega, Iq, T] = load_traces('MaxAcc');
M = torqueconstant(Iq) .* Iq;
top = v.peak_torque.value;
start = find(M > top * 3.0 / 3.5, 1);
kept = find(M >= 0.2);
kept = kept(kept >= start);
show('peak torque', max(M(kept)), 'N*m');

[highest, last] = max(omega(kept));
up = kept(1 : last);
rpm = [0 1000 2000 2100 3000 4000 5000];
for n = rpm
    at = n * pi / 30;
    % beyond 97 % of the highest speed the drive's speed control takes the torque back
    near = up(abs(omega(up) - at) <= 5 & omega(up) < 0.97 * highest);
    if ~isempty(near)
        show(sprintf('M_max at %d rpm', n), median(M(near)), 'N*m');
    end
    share = min(1, (v.no_load_speed.value - at) / (v.no_load_speed.value - v.corner_speed.value));
    show(sprintf('M_max at %d rpm, datasheet', n), top * max(0, share), 'N*m');
end
figure;
plot(omega(kept) * 30 / pi, M(kept), '.', [0 v.corner_speed.value v.no_load_speed.value] * 30 / pi, [top top 0], '--');
xlabel('speed n / rpm'); ylabel('torque M / (N*m)'); legend('measured', 'datasheet, 230 V'); grid on
keep_figure('task10');
