// A core and a memory without wait states. Two words written are the console and the end (board.c), one read the cycles
// (counter_cycles.h).
`timescale 1ns / 1ns
module bench;
    localparam int WORDS = 8 << 18;  // 8 MiB from 8000_0000
    localparam longint CYCLES_MOST = 64'd2_000_000_000;

    logic clk = 0;
    logic reset_n = 0;
    longint cycles = 0;
    logic [31:0] memory[WORDS];

    always #1 clk = !clk;

    initial begin
        $readmemh("image.hex", memory);
        #20 reset_n = 1;
    end

    always @(posedge clk) begin
        cycles <= cycles + 1;
        if (cycles > CYCLES_MOST) begin
            $display("no end after %0d cycles", cycles);
            $finish;
        end
    end

    function automatic logic [31:0] read(logic [31:0] address);
        return address == 32'hF000_0008 ? cycles[31:0] : memory[address[22:2]];
    endfunction

    task automatic write(logic [31:0] address, logic [31:0] data, logic [3:0] lanes);
        if (address == 32'hF000_0000) begin
            $write("%c", data[7:0]);
        end else if (address == 32'hF000_0004) begin
            $display("exit %0d", data);
            $finish;
        end else begin
            for (int lane = 0; lane < 4; lane++) begin
                if (lanes[lane]) memory[address[22:2]][8*lane+:8] = data[8*lane+:8];
            end
        end
    endtask

`ifdef CV32E40P
    logic instr_req, instr_valid, data_req, data_valid, data_we;
    logic [3:0] data_be;
    logic [31:0] instr_addr, instr_data, data_addr, data_out, data_in;

    always @(posedge clk) begin
        instr_valid <= reset_n && instr_req;
        instr_data <= read(instr_addr);
        data_valid <= reset_n && data_req;
        data_in <= read(data_addr);
        if (reset_n && data_req && data_we) write(data_addr, data_out, data_be);
    end

    cv32e40p_top core (
        .clk_i(clk),
        .rst_ni(reset_n),
        .pulp_clock_en_i(1'b0),
        .scan_cg_en_i(1'b0),
        .boot_addr_i(32'h8000_0000),
        .mtvec_addr_i(32'h8000_0000),
        .dm_halt_addr_i(32'h0),
        .hart_id_i(32'h0),
        .dm_exception_addr_i(32'h0),
        .instr_req_o(instr_req),
        .instr_gnt_i(instr_req),
        .instr_rvalid_i(instr_valid),
        .instr_addr_o(instr_addr),
        .instr_rdata_i(instr_data),
        .data_req_o(data_req),
        .data_gnt_i(data_req),
        .data_rvalid_i(data_valid),
        .data_we_o(data_we),
        .data_be_o(data_be),
        .data_addr_o(data_addr),
        .data_wdata_o(data_out),
        .data_rdata_i(data_in),
        .irq_i(32'h0),
        .irq_ack_o(),
        .irq_id_o(),
        .debug_req_i(1'b0),
        .debug_havereset_o(),
        .debug_running_o(),
        .debug_halted_o(),
        .fetch_enable_i(1'b1),
        .core_sleep_o()
    );
`else
    logic trap, valid;
    logic [3:0] lanes;
    logic [31:0] address, data_out;

    always @(posedge clk) begin
        if (reset_n && valid && lanes != 0) write(address, data_out, lanes);
        if (reset_n && trap) begin
            $display("trap");
            $finish;
        end
    end

    picorv32 #(
        .BARREL_SHIFTER(1),
        .ENABLE_FAST_MUL(1),
        .ENABLE_DIV(1),
        .PROGADDR_RESET(32'h8000_0000)
    ) core (
        .clk(clk),
        .resetn(reset_n),
        .trap(trap),
        .mem_valid(valid),
        .mem_instr(),
        .mem_ready(valid),
        .mem_addr(address),
        .mem_wdata(data_out),
        .mem_wstrb(lanes),
        .mem_rdata(read(address)),
        .mem_la_read(),
        .mem_la_write(),
        .mem_la_addr(),
        .mem_la_wdata(),
        .mem_la_wstrb(),
        .pcpi_valid(),
        .pcpi_insn(),
        .pcpi_rs1(),
        .pcpi_rs2(),
        .pcpi_wr(1'b0),
        .pcpi_rd(32'h0),
        .pcpi_wait(1'b0),
        .pcpi_ready(1'b0),
        .irq(32'h0),
        .eoi(),
        .trace_valid(),
        .trace_data()
    );
`endif
endmodule
